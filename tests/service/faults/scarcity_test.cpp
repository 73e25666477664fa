// No descriptor left, no process left, no memory left.
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "tests/places.h"
#include "tests/service/faults/fault_folder.h"
#include "tests/service/support/changing_worker.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kType = "model/gltf-binary";

std::size_t count_of(const std::string& word, const std::filesystem::path& file) {
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::size_t count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("without a descriptor left clients are told so, and the service comes back") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {"--workers", "1"}, log);
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  const rlimit before{1024, 1024};
  const rlimit few{service.descriptors() + 8, 1024};
  REQUIRE(::prlimit(service.pid(), RLIMIT_NOFILE, &few, nullptr) == 0);
  {
    std::vector<RawConnection> crowd;
    crowd.reserve(40);
    for (int i = 0; i < 40; ++i) crowd.emplace_back(service.port());
    // Those that got no place hear it: the last ones, unless a descriptor came free.
    std::string told;
    for (auto last = crowd.rbegin(); last != crowd.rend(); ++last) {
      told = last->read_all();
      if (told.starts_with("HTTP/1.1 503")) break;
    }
    CHECK(told.starts_with("HTTP/1.1 503"));
    CHECK(told.find("\r\nConnection: close\r\n") != std::string::npos);
    const std::size_t told_of = count_of("accept_failed", log);
    CHECK((told_of >= 1 && told_of <= 20));
  }
  ask_until(client, "/livez", 200);
  // Where descriptors are there for a connection, and not for all files of a submit.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // connections have gone
  const std::size_t idle = service.descriptors();
  std::size_t accepted = 1;
  std::size_t refused = 0;
  for (const rlim_t spare : {12U, 8U, 6U, 5U, 4U, 3U, 2U, 1U, 0U}) {
    const rlimit fewer{idle + spare, 1024};
    REQUIRE(::prlimit(service.pid(), RLIMIT_NOFILE, &fewer, nullptr) == 0);
    const Answer answer =
        client.post("/v1/jobs", noisy_torus(20), kType, {{"Cache-Control", "no-cache"}});
    CAPTURE(spare, answer.status, answer.body);
    if (answer.status == 202) ++accepted;
    if (answer.status == 503) ++refused;
    CHECK((answer.status == 202 || answer.status == 503));
  }
  CHECK(refused > 0);
  REQUIRE(::prlimit(service.pid(), RLIMIT_NOFILE, &before, nullptr) == 0);
  CHECK(client.get("/v1/jobs").json()["jobs"].size() == accepted);
  CHECK(wait_until_final(client, submit(client, noisy_torus(21)))["state"] == "succeeded");
  CHECK(count_of("accept_failed", log) <= 40);
}

#ifdef FAIRWAY_SANITIZED
TEST_CASE("faults are not injected under sanitizers") {
  WARN("SKIPPED: a sanitizer's library must be the first one");
}
#else
TEST_CASE("a job whose worker cannot be started waits until one can") {
  const FaultFolder faults;
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"}, {}, faults.environment());
  const HttpClient client = service.client();
  REQUIRE(wait_until_final(client, submit(client, small_glb()))["state"] == "succeeded");
  faults.allow_processes(false);
  std::vector<std::string> paths;
  paths.reserve(3);
  for (int i = 0; i < 3; ++i) paths.push_back(submit(client, noisy_torus(20 + i)));
  CHECK(ask_until(client, "/readyz", 503)["checks"]["worker"]["ok"] == false);
  CHECK(client.get("/livez").status == 200);
  faults.allow_processes(true);
  for (const std::string& path : paths) {
    const Json job = wait_until_final(client, path);
    CAPTURE(job.dump());
    CHECK(job["state"] == "succeeded");
    CHECK(job["attempt"] == 1);
  }
  CHECK(ask_until(client, "/readyz", 200)["checks"]["worker"]["ok"] == true);
}

TEST_CASE("a worker whose N-th allocation fails says so, whatever N is") {
  const TemporaryDirectory directory;
  const TemporaryDirectory place;
  const auto which = place.path() / "which";
  const ChangingWorker worker("FAIRWAY_FAULT_ALLOCATION=$(cat " + which.string() +
                              ") LD_PRELOAD=" + preloaded("allocation_fault") + " exec " +
                              program("fairway") + " \"$@\"");
  const ServiceProcess service(directory.path(), {"--workers", "1", "--worker", worker.path()});
  const HttpClient client = service.client();
  std::size_t without_memory = 0;
  std::size_t done = 0;
  long number = 1;
  for (int i = 0; i < 24; ++i, number += 1 + number / 3) {
    for (const char* rest : {"", "+"}) {
      const std::string order = std::to_string(number) + rest;
      std::ofstream(which) << order;
      // The worker that waits for the next job was started with the order before.
      client.post("/v1/denoise", small_glb(), kType);
      const Answer answer =
          client.post("/v1/denoise", small_glb(), kType, {{"Cache-Control", "no-cache"}});
      CAPTURE(order, answer.body);
      CHECK((answer.status == 200 || answer.problem() == "memory_limit"));
      ++(answer.status == 200 ? done : without_memory);
    }
  }
  CAPTURE(number);
  CHECK(without_memory > 10);
  CHECK(done > 0);
}
#endif
