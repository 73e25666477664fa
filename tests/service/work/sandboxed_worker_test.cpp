// The walls around the workers of a running service, as the kernel tells of them.
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include "server/fairwayd/operations/sandbox_check.h"
#include "server/fairwayd/work/worker_run.h"
#include "server/os/file.h"
#include "tests/places.h"
#include "tests/service/support/changing_worker.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/service/support/worker_processes.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";

std::filesystem::path about(pid_t pid, const char* what) {
  return fmt::format("/proc/{}/{}", pid, what);
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The lines "Name:\tvalue" of a process's status.
std::map<std::string, std::string> status_of(pid_t pid) {
  std::map<std::string, std::string> status;
  std::istringstream lines(text_of(about(pid, "status")));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::size_t value = line.find_first_not_of(" \t", colon + 1);
    status[line.substr(0, colon)] = value == std::string::npos ? "" : line.substr(value);
  }
  return status;
}

std::set<std::string> descriptors_of(pid_t pid) {
  std::set<std::string> open;
  for (const auto& entry : std::filesystem::directory_iterator(about(pid, "fd"))) {
    open.insert(entry.path().filename());
  }
  return open;
}

rlimit limit_of(pid_t pid, __rlimit_resource resource) {
  rlimit limit = {};
  REQUIRE(::prlimit(pid, resource, nullptr, &limit) == 0);
  return limit;
}

/// A service with one job that does not end by itself.
class BusyService {
 public:
  explicit BusyService(const std::vector<std::string>& options = {"--workers", "1"})
      : service_(directory_.path(), options),
        path_(submit(service_.client(), noisy_torus(300), kLong)) {
    wait_until_busy(service_.client(), path_);
  }

  pid_t worker() const {
    const auto workers = service_.workers();
    REQUIRE(workers.size() == 1);
    return workers.front();
  }
  /// The one that stands by, once it does.
  pid_t waiting_worker() const {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    std::vector<pid_t> waiting;
    while ((waiting = children_called(kWaitingWorker, service_.pid())).size() != 1) {
      REQUIRE(std::chrono::steady_clock::now() < until);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return waiting.front();
  }
  ServiceProcess& service() { return service_; }
  const std::string& job() const { return path_; }

 private:
  const TemporaryDirectory directory_;
  ServiceProcess service_;
  const std::string path_;
};

bool is_gone(pid_t pid) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (::kill(pid, 0) == 0) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// A small mesh for a worker of one's own.
class SmallTask {
 public:
  SmallTask() {
    REQUIRE((input_ && output_ && never_));
    const std::string mesh = noisy_torus(20);
    REQUIRE(write_all(input_->get(), std::as_bytes(std::span(mesh))));
  }

  Result<WorkerEnd> run(const std::filesystem::path& worker, const WorkerLimits& limits) const {
    const Log log(output_->get());
    WorkerPool pool(worker, limits, 0, log);
    const WorkerWatch watch{[](const Progress&) {}, [](std::string_view) {}, [] { return true; },
                            *never_};
    return run_worker(pool, {input_->get(), output_->get(), {}, limits}, watch);
  }

 private:
  const TemporaryDirectory directory_;
  const Result<UniqueFd> input_ = open_file(directory_.path() / "input", O_RDWR | O_CREAT);
  const Result<UniqueFd> output_ = open_file(directory_.path() / "output", O_RDWR | O_CREAT);
  const Result<EventFlag> never_ = EventFlag::create();
};

}  // namespace

TEST_CASE("a worker at a job is filtered, and can gain nothing") {
  BusyService busy;
  auto status = status_of(busy.worker());
#ifndef FAIRWAY_SANITIZED
  CHECK(status["Seccomp"] == "2");
  CHECK(status["Threads"] == "1");
#endif
  CHECK(status["NoNewPrivs"] == "1");
  for (const char* capabilities : {"CapInh", "CapPrm", "CapEff"}) {
    CHECK(status[capabilities] == "0000000000000000");
  }
}

TEST_CASE("a worker at a job has its three descriptors and no environment") {
  BusyService busy;
  CHECK(descriptors_of(busy.worker()) == std::set<std::string>{"0", "1", "2"});
  const auto fd = about(busy.worker(), "fd");
  CHECK(std::filesystem::read_symlink(fd / "0").string().find("/blobs/") != std::string::npos);
  CHECK(std::filesystem::read_symlink(fd / "1").string().find("/spool/") != std::string::npos);
  CHECK(std::filesystem::read_symlink(fd / "2").string().starts_with("socket:"));
  CHECK(text_of(about(busy.worker(), "environ")).empty());
}

TEST_CASE("a worker has limits that leave no room for cores, processes and descriptors") {
  BusyService busy({"--workers", "1", "--deadline", "200"});
  CHECK(limit_of(busy.worker(), RLIMIT_CORE).rlim_max == 0);
  CHECK(limit_of(busy.worker(), RLIMIT_CPU).rlim_cur == 210);
#ifndef FAIRWAY_SANITIZED
  for (const auto resource : {RLIMIT_NPROC, RLIMIT_NOFILE}) {
    CHECK(limit_of(busy.worker(), resource).rlim_max == 0);
  }
  for (const auto resource : {RLIMIT_AS, RLIMIT_FSIZE}) {
    CHECK(limit_of(busy.worker(), resource).rlim_max == std::uint64_t{2} << 30);
  }
#endif
}

TEST_CASE("workers are in namespaces of their own, or the self-test says why not") {
  BusyService busy;
  const auto test = run_self_test(program("fairway"), {});
  REQUIRE(test);
  const bool separate = test->note.find("no namespaces") == std::string::npos;
  for (const char* kind : {"ns/user", "ns/net"}) {
    const auto own = std::filesystem::read_symlink(about(busy.worker(), kind));
    const auto servers = std::filesystem::read_symlink(about(busy.service().pid(), kind));
    CAPTURE(kind, test->note);
    CHECK((own != servers) == separate);
  }
}

TEST_CASE("a worker that waits is confined but for its filter, and holds a socket only") {
  BusyService busy;
  const pid_t waiting = busy.waiting_worker();
  auto status = status_of(waiting);
  CHECK(status["NoNewPrivs"] == "1");
  CHECK(status["CapEff"] == "0000000000000000");
  CHECK(limit_of(waiting, RLIMIT_CORE).rlim_max == 0);
  CHECK(text_of(about(waiting, "environ")).empty());
  for (const std::string& name : descriptors_of(waiting)) {
    CHECK(
        std::filesystem::read_symlink(about(waiting, "fd") / name).string().starts_with("socket:"));
  }
}

TEST_CASE("a service that stops ends waiting workers at once and lets the job go on") {
  BusyService busy({"--workers", "1", "--drain", "600"});
  const pid_t waiting = busy.waiting_worker();
  const pid_t working = busy.worker();
  busy.service().signal(SIGTERM);
  CHECK(is_gone(waiting));
  CHECK(::kill(working, 0) == 0);
  busy.service().signal(SIGTERM);
  CHECK(busy.service().wait().code == 0);
}

TEST_CASE("a worker that waits does not outlive a killed server") {
  BusyService busy;
  const pid_t waiting = busy.waiting_worker();
  busy.service().kill();
  CHECK(is_gone(waiting));
}

TEST_CASE("a job whose worker makes two forbidden calls fails for good") {
  BusyService busy;
  const HttpClient client = busy.service().client();
  for (int attempt = 1; attempt <= 2; ++attempt) {
    follow(client, busy.job(), [&](const Json& job) {
      return job["state"] == "running" && job["attempt"] == attempt &&
             job.value("/progress/stage"_json_pointer, "") == "flow";
    });
    // What the kernel sends for one.
    REQUIRE(::kill(busy.worker(), SIGSYS) == 0);
  }
  const Json job = wait_until_final(client, busy.job());
  CHECK(job["state"] == "failed");
  CHECK(job["problem"]["code"] == "worker_crashed");
}

TEST_CASE("a worker whose result outgrows its limit is ended, and the job says so") {
  const SmallTask task;
  WorkerLimits limits;
  limits.address_space = 0;
  auto end = task.run(program("fairway"), limits);
  REQUIRE(end);
  CHECK(std::holds_alternative<Finished>(*end));
  limits.result_bytes = 1000;
  end = task.run(program("fairway"), limits);
  REQUIRE(end);
  REQUIRE(std::holds_alternative<Failed>(*end));
  CHECK(std::get<Failed>(*end).error.code == ErrorCode::too_large);
}

#ifndef FAIRWAY_SANITIZED  // sanitizers reserve terabytes
TEST_CASE("a worker whose limits were lowered before it set its own keeps to the lower ones") {
  const SmallTask task;
  const ChangingWorker worker("ulimit -v 1048576\nexec " + program("fairway") + " \"$@\"");
  WorkerLimits limits;
  limits.address_space = std::uint64_t{2} << 30;
  const auto end = task.run(worker.path(), limits);
  REQUIRE(end);
  CHECK(std::holds_alternative<Finished>(*end));
}
#endif
