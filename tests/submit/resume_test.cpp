// Batches that are broken off on either side.
#include <csignal>
#include <memory>
#include <set>
#include <span>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/os/sha256.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/submit/submit_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr std::size_t kInFlight = 4;

std::string sha256(const std::string& text) {
  Sha256 digest;
  digest.update(std::as_bytes(std::span(text)));
  return digest.hex();
}

/// Every file of a summary has the result that its job on the server states, from a job of its own.
void check_results(const SubmitPlace& place, const SubmitRun& run, const HttpClient& client) {
  std::set<std::string> jobs;
  const Json summary = run.summary();
  for (const Json& file : summary["files"]) {
    const std::filesystem::path result = file["result"]["file"].get<std::string>();
    CAPTURE(result);
    const Json job = client.get("/v1/jobs/" + file["job"].get<std::string>()).json();
    const std::string made = job["result"]["sha256"];
    const std::string taken = job["input"]["sha256"];
    CHECK(sha256(place.result(result.filename().string())) == made);
    CHECK(sha256(read_file(file["file"].get<std::string>())) == taken);
    jobs.insert(file["job"].get<std::string>());
  }
  CHECK(jobs.size() == summary["files"].size());
  CHECK(place.results().size() == summary["files"].size());
  CHECK(place.parts() == 0);
}

}  // namespace

TEST_CASE("200 files survive the death of the server in the middle and end with 200 results") {
  const SubmitPlace place;
  const auto files = place.write_meshes(200);
  const std::uint16_t port = free_port();
  const std::vector<std::string> listen = {"--listen", fmt::format("127.0.0.1:{}", port)};
  auto first = std::make_unique<ServiceProcess>(place.data(), listen);
  SubmitProcess client(place.arguments(port, files));
  place.wait_for_journal("\"result\"", 70);
  first->kill();
  CHECK_FALSE(client.is_over());
  const std::size_t before = place.results().size();
  CHECK(before < 200);
  const ServiceProcess second(place.data(), listen);
  const SubmitRun run = client.wait();
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(run.summary()["counts"]["succeeded"] == 200);
  check_results(place, run, second.client());
  const Json list = second.client().get("/v1/jobs?limit=200").json();
  CHECK(list["counts"]["succeeded"] == 200);
  CHECK_FALSE(list.contains("next"));
}

TEST_CASE("a client that was killed goes on with the jobs that it has") {
  const SubmitPlace place;
  const auto files = place.write_meshes(60);
  const ServiceProcess service(place.data());
  {
    SubmitProcess client(place.arguments(service.port(), files));
    place.wait_for_journal("\"result\"", 20);
    client.signal(SIGKILL);
    CHECK(client.wait().code == -1);
  }
  const std::size_t before = place.results().size();
  CHECK(before < 60);
  const SubmitRun run = place.submit(service.port(), files);
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(run.summary()["counts"]["kept"] >= before - kInFlight);
  check_results(place, run, service.client());
  // An upload whose answer was not yet written down is sent again, and finds its job by its key.
  const Json jobs = service.client().get("/v1/jobs?limit=200").json()["jobs"];
  CHECK(jobs.size() == 60);
}

TEST_CASE("an interrupted client says how to go on and leaves its jobs to the next run") {
  const SubmitPlace place;
  const ServiceProcess service(place.data(), {"--workers", "1"});
  const std::string busy =
      submit(service.client(), noisy_torus(300), R"({"method":"anisotropic","steps":10000})");
  const auto files = place.write_meshes(2);
  SubmitProcess client(place.arguments(service.port(), files));
  place.wait_for_journal("\"job\"", 2);
  client.signal(GENERATE(SIGINT, SIGTERM));
  const SubmitRun first = client.wait();
  CHECK(first.code == 130);
  CHECK(first.errors.find("the same command goes on") != std::string::npos);
  CHECK(first.summary()["counts"]["unfinished"] == 2);
  CHECK(place.parts() == 0);
  service.client().remove(busy);
  const SubmitRun second = place.submit(service.port(), files);
  CHECK(second.code == 0);
  check_results(place, second, service.client());
  CHECK(service.client().get("/v1/jobs").json()["jobs"].size() == 3);
}

TEST_CASE("two clients never work in one folder") {
  const SubmitPlace place;
  const ServiceProcess service(place.data(), {"--workers", "1"});
  submit(service.client(), noisy_torus(300), R"({"method":"anisotropic","steps":10000})");
  const auto files = place.write_meshes(1);
  const SubmitProcess client(place.arguments(service.port(), files));
  place.wait_for_journal("\"job\"", 1);
  const SubmitRun second = place.submit(service.port(), files);
  CHECK(second.code == 2);
  CHECK(second.errors.find("Another fairway-submit") != std::string::npos);
}

TEST_CASE("a batch goes on at another server, where neither jobs nor failures of the first count") {
  const SubmitPlace place;
  auto files = place.write_meshes(4);
  files.push_back(place.write("large.glb", noisy_torus(20)));
  {
    const ServiceProcess service(place.data(), {"--max-body", "10000"});
    const SubmitRun run = place.submit(service.port(), {files[0], files[1], files[4]});
    CHECK(run.summary()["files"][2]["problem"]["code"] == "too_large");
  }
  std::filesystem::remove(place.out() / "m001.glb");
  const TemporaryDirectory elsewhere;
  const ServiceProcess service(elsewhere.path());
  const SubmitRun run = place.submit(service.port(), files);
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(run.summary()["counts"]["kept"] == 1);
  CHECK(place.results().size() == 5);
}

TEST_CASE("a server that lost its jobs gets them anew") {
  const SubmitPlace place;
  const auto files = place.write_meshes(2);
  const std::vector<std::string> listen = {"--listen", fmt::format("127.0.0.1:{}", free_port())};
  {
    const ServiceProcess service(place.data(), listen);
    REQUIRE(place.submit(service.port(), files).code == 0);
  }
  std::filesystem::remove(place.out() / "m001.glb");
  const TemporaryDirectory empty;
  const ServiceProcess service(empty.path(), listen);
  const SubmitRun run = place.submit(service.port(), files);
  CHECK(run.code == 0);
  CHECK(run.summary()["counts"]["kept"] == 1);
  CHECK(run.summary()["files"][1]["state"] == "succeeded");
}
