// How the service ends: what runs may come to its end, and what does not is handed back.
#include <csignal>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kSteps = R"({"method":"anisotropic_prescribed","steps":400})";
const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";
const std::vector<std::string> kPatient = {"--workers", "1", "--drain", "600"};

/// Of the jobs, oldest first.
std::vector<JobState> states_in(const TemporaryDirectory& directory) {
  auto store = SqliteJobStore::open(directory.path() / "jobs.sqlite");
  REQUIRE(store);
  const auto jobs = (*store)->list({});
  REQUIRE(jobs);
  std::vector<JobState> states;
  for (const Job& job : jobs->jobs) states.insert(states.begin(), job.state);
  return states;
}

/// Until nobody can connect any more.
void wait_until_closed(const HttpClient& client) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (client.get("/livez").status != 0) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace

TEST_CASE("a stopped server lets what runs come to its end, and begins nothing") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), kPatient);
  const std::string running = submit(service.client(), noisy_torus(60), kSteps);
  wait_until_busy(service.client(), running);
  submit(service.client(), small_glb());
  CHECK(service.stop().code == 0);
  CHECK(states_in(directory) == std::vector{JobState::succeeded, JobState::queued});
}

TEST_CASE("a waiting client gets its mesh while the server drains") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), kPatient);
  const HttpClient client = service.client();
  Answer answer;
  std::jthread waiting([&] {
    answer = client.post("/v1/denoise?params=" + percent_encoded(kSteps), noisy_torus(60));
  });
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (service.workers().empty()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(service.stop().code == 0);
  waiting.join();
  CHECK(answer.status == 200);
  CHECK(answer.body.starts_with("glTF"));
}

TEST_CASE("a draining server accepts nobody, and a second signal ends the wait") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), kPatient);
  const std::string path = submit(service.client(), noisy_torus(300), kLong);
  wait_until_busy(service.client(), path);
  service.signal(SIGTERM);
  wait_until_closed(service.client());
  CHECK(service.workers().size() == 1);
  CHECK(service.stop().code == 0);
  CHECK(states_in(directory) == std::vector{JobState::queued});
}

TEST_CASE("what does not end within the time to drain is handed back") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), {"--drain", "1"});
  const std::string path = submit(service.client(), noisy_torus(300), kLong);
  wait_until_busy(service.client(), path);
  CHECK(service.stop().code == 0);
  CHECK(states_in(directory) == std::vector{JobState::queued});
}

TEST_CASE("an idle server does not wait for the time to drain") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), {"--drain", "86400", "--admin-listen", "127.0.0.1:0"});
  CHECK(service.stop().code == 0);
}
