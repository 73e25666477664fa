// The supervisor's side of a worker, against programs that misbehave in every way.
#include "server/fairwayd/work/worker_run.h"

#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "proto/messages/problem.h"
#include "server/os/file.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

const std::string kFinished = R"({"event":"finished","output":"glb","report":{}})";

/// Runs a shell script in the place of `fairway worker`; 0, 1, 2 are as a worker has them.
class Fixture {
 public:
  WorkerEnd run(const std::string& script) {
    auto end = try_run(script);
    REQUIRE(end);
    return *end;
  }

  Result<WorkerEnd> try_run(const std::string& script) {
    const auto program = directory_.path() / "worker";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    ::chmod(program.c_str(), 0700);
    auto input = open_file("/dev/null", O_RDONLY);
    auto output = open_file(directory_.path() / "output", O_RDWR | O_CREAT | O_TRUNC);
    auto interrupt = EventFlag::create();
    REQUIRE((input && output && interrupt));
    WorkerPool pool(program, limits, 0, log_);
    const WorkerTask task{input->get(), output->get(), {}, limits};
    const WorkerWatch watch{[&](const Progress& progress) { progresses.push_back(progress); },
                            [&](std::string_view text) { texts.emplace_back(text); },
                            [&] { return ++asked <= patience; }, *interrupt,
                            [&](const ExitStatus& status) { exits.push_back(status); }};
    return run_worker(pool, task, watch);
  }

  WorkerLimits limits{0, 60s, 20s};
  int patience = 1000000;
  int asked = 0;
  std::vector<Progress> progresses;
  std::vector<std::string> texts;
  std::vector<ExitStatus> exits;

 private:
  test::TemporaryDirectory directory_;
  UniqueFd null_{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
  Log log_{null_.get()};
};

}  // namespace

TEST_CASE("a worker that says so and exits with 0 has finished") {
  Fixture f;
  const auto end = f.run("head -n 1 <&2 >/dev/null\necho '" + kFinished + "' >&2");
  CHECK(std::holds_alternative<Finished>(end));
}

TEST_CASE("progress is heard in order and other text is only passed on") {
  Fixture f;
  f.run(R"(echo '{"event":"progress","stage":"flow","step":1,"of":2,"fraction":0.5}' >&2
echo 'some library: warning' >&2
echo '{"event":"progress","stage":"flow","step":2,"of":2,"fraction":0.9}' >&2
echo ')" +
        kFinished + "' >&2");
  REQUIRE(f.progresses.size() == 2);
  CHECK(f.progresses[1].step == 2);
  CHECK(f.texts == std::vector<std::string>{"some library: warning"});
}

TEST_CASE("what a worker said before it ended is heard, however fast it was") {
  for (int i = 0; i < 50; ++i) {
    Fixture f;
    REQUIRE(std::holds_alternative<Finished>(f.run("echo '" + kFinished + "' >&2")));
  }
}

TEST_CASE("a worker that names a problem has failed, whatever its exit code") {
  Fixture f;
  const auto end = f.run(
      R"(echo '{"event":"failed","problem":{"code":"no_triangles","detail":"None."}}' >&2; exit 14)");
  REQUIRE(std::holds_alternative<Failed>(end));
  CHECK(std::get<Failed>(end).error.code == ErrorCode::no_triangles);
}

TEST_CASE("a result is not believed where the exit code says otherwise") {
  Fixture f;
  const auto end = f.run("echo '" + kFinished + "' >&2; exit 3");
  REQUIRE(std::holds_alternative<WorkerDied>(end));
  CHECK(std::get<WorkerDied>(end).how == "exit code 3");
}

TEST_CASE("silence with exit code 0 is no result") {
  Fixture f;
  CHECK(std::holds_alternative<WorkerDied>(f.run("exit 0")));
}

TEST_CASE("a signal is a death of the worker, in its decoder or after it") {
  const auto death = [](const std::string& before, const std::string& signal) {
    Fixture f;
    const auto end = f.run(before + "kill -" + signal + " $$");
    REQUIRE(std::holds_alternative<WorkerDied>(end));
    return std::get<WorkerDied>(end);
  };
  const auto told = [](const std::string& stage) {
    return R"(echo '{"event":"progress","stage":")" + stage +
           R"(","step":1,"of":2,"fraction":0.5}' >&2;)";
  };
  CHECK(death("", "SEGV").how == fmt::format("signal {}", SIGSEGV));
  CHECK(death("", "SEGV").cause.code == ErrorCode::decoder_failed);
  CHECK(death(told("decode"), "ABRT").cause.code == ErrorCode::decoder_failed);
  CHECK(death(told("decode"), "KILL").cause.code == ErrorCode::worker_crashed);
  CHECK(death(told("topology"), "SEGV").cause.code == ErrorCode::worker_crashed);
}

TEST_CASE("a forbidden system call is a death of the worker, and named in its log line") {
  Fixture f;
  const auto end = f.run("kill -SYS $$");
  REQUIRE(std::holds_alternative<WorkerDied>(end));
  CHECK(std::get<WorkerDied>(end).cause.code == ErrorCode::decoder_failed);
  CHECK(std::get<WorkerDied>(end).how.starts_with("forbidden system call"));
}

TEST_CASE("a result beyond its limit is a failure that says so") {
  Fixture f;
  const auto end = f.run("kill -XFSZ $$");
  REQUIRE(std::holds_alternative<Failed>(end));
  CHECK(std::get<Failed>(end).error.code == ErrorCode::too_large);
}

TEST_CASE("the exit code of the memory limit is told apart from a crash") {
  Fixture f;
  const auto end = f.run(fmt::format("exit {}", problem_kind(ErrorCode::memory_limit).exit_code));
  REQUIRE(std::holds_alternative<WorkerDied>(end));
  CHECK(std::get<WorkerDied>(end).cause.code == ErrorCode::memory_limit);
}

TEST_CASE("a worker past its deadline is killed") {
  Fixture f;
  f.limits.deadline = 1s;
  const auto end = f.run("exec sleep 60");
  REQUIRE(std::holds_alternative<Failed>(end));
  CHECK(std::get<Failed>(end).error.code == ErrorCode::time_limit);
}

TEST_CASE("a worker that uses up its processor time has met a limit") {
  Fixture f;
  f.limits.cpu = 1s;
  const auto end = f.run("while :; do :; done");
  REQUIRE(std::holds_alternative<Failed>(end));
  CHECK(std::get<Failed>(end).error.code == ErrorCode::time_limit);
}

TEST_CASE("a worker is killed once nobody wants it to go on") {
  Fixture f;
  f.patience = 1;
  CHECK(std::holds_alternative<WorkerStopped>(f.run("exec sleep 60")));
}

TEST_CASE("an endless line and a second end are broken protocol") {
  Fixture endless;
  CHECK(std::holds_alternative<WorkerDied>(
      endless.run("head -c 3000000 /dev/zero >&2; exec sleep 60")));
  Fixture twice;
  CHECK(std::holds_alternative<WorkerDied>(
      twice.run("echo '" + kFinished + "' >&2; echo '" + kFinished + "' >&2; exec sleep 60")));
}

TEST_CASE("a worker that has finished but does not leave is killed") {
  Fixture f;
  CHECK(std::holds_alternative<WorkerDied>(f.run("echo '" + kFinished + "' >&2; exec sleep 60")));
}

TEST_CASE("a worker that never reads and closes its end is followed to its exit") {
  Fixture f;
  const auto end = f.run("exec 2>&-; sleep 0.2; exit 5");
  REQUIRE(std::holds_alternative<WorkerDied>(end));
  CHECK(std::get<WorkerDied>(end).how == "exit code 5");
}

TEST_CASE("every worker's exit is told once, with its largest memory") {
  for (const char* script : {"exit 3", "kill -9 $$", "exec sleep 60"}) {
    Fixture f;
    f.patience = 1;
    f.run(script);
    REQUIRE(f.exits.size() == 1);
    CHECK(f.exits.front().peak_resident_bytes > 100'000);
  }
}
