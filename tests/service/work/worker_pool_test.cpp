// Workers that are started ahead of their orders.
#include "server/fairwayd/work/worker_pool.h"

#include <csignal>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "server/fairwayd/work/worker_run.h"
#include "server/os/file.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

const std::string kAnswers =
    R"(read -r order <&2; echo '{"event":"finished","output":"glb","report":{}}' >&2)";

template <class Condition>
void wait_until(const Condition& condition) {
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (!condition()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(2ms);
  }
}

bool is_alive(pid_t pid) {
  return ::kill(pid, 0) == 0;
}

/// Keeps workers that are scripts, each of which notes its pid when it starts.
class Fixture {
 public:
  explicit Fixture(std::size_t kept = 1, const std::string& script = kAnswers) {
    become(script);
    pool_.emplace(program_, WorkerLimits{}, kept, log_);
    REQUIRE(pool_->start());
  }

  /// Replaces the program in one step.
  void become(const std::string& script) const {
    const auto next = directory_.path() / "next";
    std::ofstream(next) << "#!/bin/sh\nhere=" << directory_.path().string()
                        << "\necho $$ >> $here/starts\n"
                        << script << "\n";
    ::chmod(next.c_str(), 0700);
    std::filesystem::rename(next, program_);
  }

  /// Pids in the order of their starts, once there are so many.
  std::vector<pid_t> started(std::size_t count) const {
    std::vector<pid_t> pids;
    wait_until([&] {
      pids.clear();
      std::ifstream file(starts_);
      for (pid_t pid; file >> pid;) pids.push_back(pid);
      return pids.size() >= count;
    });
    return pids;
  }

  Result<WorkerEnd> run() {
    const auto null = open_file("/dev/null", O_RDWR);
    const auto never = EventFlag::create();
    REQUIRE((null && never));
    const WorkerWatch watch{[](const Progress&) {}, [](std::string_view) {}, [] { return true; },
                            *never};
    return run_worker(*pool_, {null->get(), null->get(), {}, {}}, watch);
  }

  WorkerPool& pool() { return *pool_; }
  void destroy_pool() { pool_.reset(); }

 private:
  const test::TemporaryDirectory directory_;
  const std::filesystem::path program_ = directory_.path() / "worker";
  const std::filesystem::path starts_ = directory_.path() / "starts";
  const UniqueFd null_{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
  const Log log_{null_.get()};
  std::optional<WorkerPool> pool_;
};

}  // namespace

TEST_CASE("workers start before anybody asks, and the oldest is taken first") {
  Fixture f(2);
  const auto pids = f.started(2);
  const auto first = f.pool().take();
  const auto second = f.pool().take();
  REQUIRE((first && second));
  // Two programs that start at once may tell of it in either order; the kernel counts pids up.
  CHECK(std::set{first->process.pid(), second->process.pid()} ==
        std::set(pids.begin(), pids.end()));
  CHECK(first->process.pid() < second->process.pid());
  CHECK(first->was_kept);
}

TEST_CASE("a worker that was taken is replaced while it works") {
  Fixture f;
  const auto taken = f.pool().take();
  REQUIRE(taken);
  CHECK(f.started(2).size() >= 2);
  CHECK(is_alive(taken->process.pid()));
}

TEST_CASE("a worker that dies while it waits is replaced, and no task notices") {
  Fixture f;
  const pid_t first = f.started(1)[0];
  ::kill(first, SIGKILL);
  wait_until([&] { return !is_alive(first); });
  const auto end = f.run();
  REQUIRE(end);
  CHECK(std::holds_alternative<Finished>(*end));
  CHECK(f.started(2).size() >= 2);
}

TEST_CASE("a worker that cannot be given a task is passed over") {
  Fixture f(1, "if mkdir $here/once 2>/dev/null; then exec 0<&- 1>&- 2>&-; exec sleep 60; fi\n" +
                   kAnswers);
  const pid_t deaf = f.started(1)[0];
  wait_until([&] { return !std::filesystem::exists(fmt::format("/proc/{}/fd/2", deaf)); });
  const auto end = f.run();
  REQUIRE(end);
  CHECK(std::holds_alternative<Finished>(*end));
  CHECK_FALSE(is_alive(deaf));
}

TEST_CASE("a replaced program takes the place of the workers that wait") {
  Fixture f;
  const pid_t old = f.started(1)[0];
  f.become("exec sleep 60");
  const pid_t next = f.started(2)[1];
  wait_until([&] { return !is_alive(old); });
  // A worker may tell of its start before it is one that waits: then another one is started.
  std::optional<WaitingWorker> taken;
  while (!taken || !taken->was_kept) {
    auto one = f.pool().take();
    REQUIRE(one);
    taken.emplace(*std::move(one));
  }
  CHECK(taken->process.pid() == next);
}

TEST_CASE("a program replaced at the last moment is the one that is taken") {
  Fixture f;
  f.started(1);
  f.become("exit 7");
  const auto end = f.run();
  REQUIRE(end);
  REQUIRE(std::holds_alternative<WorkerDied>(*end));
  CHECK(std::get<WorkerDied>(*end).how == "exit code 7");
}

TEST_CASE("a program that does not stay up is tried less and less often") {
  Fixture f;
  f.started(1);
  f.become("exit 1");
  f.started(3);
  const auto before = f.started(3).size();
  std::this_thread::sleep_for(2s);
  // At pauses of half a second that double there is room for two more.
  CHECK(f.started(3).size() <= before + 3);
}

TEST_CASE("a closed pool ends those that wait, and starts none in advance") {
  Fixture f;
  const pid_t waiting = f.started(1)[0];
  f.pool().close();
  CHECK_FALSE(is_alive(waiting));
  const auto taken = f.pool().take();
  REQUIRE(taken);
  CHECK_FALSE(taken->was_kept);
}

TEST_CASE("no worker outlives its pool") {
  Fixture f;
  const pid_t waiting = f.started(1)[0];
  f.destroy_pool();
  CHECK_FALSE(is_alive(waiting));
}
