// What servers say no with, for now or for good.
#include <fstream>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/submit/submit_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace fs = std::filesystem;

TEST_CASE("a full queue is waited for") {
  const SubmitPlace place;
  const fs::path log = place.write("log", "");
  const ServiceProcess service(place.data(), {"--workers", "1", "--queue", "1"}, log);
  std::vector<std::string> files;
  files.reserve(4);
  for (int i = 0; i < 4; ++i) {
    files.push_back(place.write(fmt::format("t{}.glb", i), noisy_torus(60)));
  }
  const SubmitRun run =
      place.submit(service.port(), files, {"--concurrency", "8", "--params", R"({"steps":200})"});
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(place.results().size() == 4);
  CHECK(read_file(log).find("\"status\":429") != std::string::npos);
}

TEST_CASE("a queue that stays full is given up, and told as unfinished") {
  const SubmitPlace place;
  const ServiceProcess service(place.data(), {"--workers", "1", "--queue", "1"});
  const std::string parameters = R"({"method":"anisotropic","steps":10000})";
  const std::string running = submit(service.client(), noisy_torus(300), parameters);
  wait_until_busy(service.client(), running);
  submit(service.client(), small_glb());
  const SubmitRun run = place.submit(service.port(), place.write_meshes(1), {"--retry-for", "3"});
  CHECK(run.code == 1);
  const Json file = run.summary()["files"][0];
  CHECK(file["state"] == "unfinished");
  CHECK(file["problem"]["code"] == "queue_full");
  CHECK(run.errors.find("tries again") != std::string::npos);
}

TEST_CASE("a server that refuses a large file in the middle of its upload is heard") {
  const SubmitPlace place;
  const ServiceProcess service(place.data(), {"--max-body", "100000"});
  const std::string large = place.write("large.glb", small_glb() + std::string(30 << 20, 'x'));
  const auto small = place.write_meshes(1);
  const SubmitRun run =
      place.submit(service.port(), {large, small[0]}, {"--concurrency", "1", "--retry-for", "20"});
  CAPTURE(run.errors);
  CHECK(run.code == 1);
  CHECK(run.summary()["files"][0]["problem"]["code"] == "too_large");
  CHECK(run.summary()["files"][1]["state"] == "succeeded");
}

TEST_CASE("no server within the limit ends the batch with 3") {
  const SubmitPlace place;
  const SubmitRun run = place.submit(free_port(), place.write_meshes(9), {"--retry-for", "1"});
  CHECK(run.code == 3);
  CHECK(run.summary()["counts"]["unfinished"] == 9);
  CHECK(run.errors.find("could not be reached") != std::string::npos);
}

TEST_CASE("a damaged result never gets its name") {
  const SubmitPlace place;
  const ServiceProcess service(place.data());
  const auto files = place.write_meshes(1);
  REQUIRE(place.submit(service.port(), files).code == 0);
  const std::string good = place.result("m000.glb");
  fs::remove(place.out() / "m000.glb");
  fs::path stored;
  for (const auto& entry : fs::recursive_directory_iterator(place.data())) {
    if (entry.is_regular_file() && read_file(entry.path()) == good) stored = entry.path();
  }
  REQUIRE_FALSE(stored.empty());
  std::string bad = good;
  bad[bad.size() / 2] = static_cast<char>(bad[bad.size() / 2] ^ 1);
  std::ofstream(stored, std::ios::binary) << bad;
  const SubmitRun run = place.submit(service.port(), files, {"--retry-for", "1"});
  CHECK(run.code == 1);
  CHECK(place.results().empty());
  CHECK(place.parts() == 0);
  CHECK(run.errors.find("a result came damaged") != std::string::npos);
  std::ofstream(stored, std::ios::binary) << good;
  CHECK(place.submit(service.port(), files).code == 0);
  CHECK((place.result("m000.glb") == good));
}

TEST_CASE("a job that somebody cancels is a failure, and another job in the next run") {
  const SubmitPlace place;
  const ServiceProcess service(place.data(), {"--workers", "1"});
  const auto parameters =
      std::vector<std::string>{"--params", R"({"method":"anisotropic","steps":10000})"};
  const std::string torus = place.write("torus.glb", noisy_torus(300));
  SubmitProcess client(place.arguments(service.port(), {torus}, parameters));
  place.wait_for_journal("\"job\"", 1);
  const Json jobs = service.client().get("/v1/jobs").json()["jobs"];
  REQUIRE(jobs.size() == 1);
  const std::string first = jobs[0]["id"];
  REQUIRE(service.client().post("/v1/jobs/" + first + "/cancel").status == 200);
  const SubmitRun run = client.wait();
  CHECK(run.code == 1);
  CHECK(run.summary()["files"][0]["problem"]["code"] == "canceled");
  SubmitProcess again(place.arguments(service.port(), {torus}, parameters));
  place.wait_for_journal("\"job\"", 2);
  CHECK(service.client().get("/v1/jobs").json()["jobs"].size() == 2);
}

TEST_CASE("names that collide are refused before anything starts") {
  const SubmitPlace place;
  const std::uint16_t port = free_port();
  const std::string a = place.write("a/part.glb", small_glb());
  const std::string b = place.write("b/part.glb", small_glb());
  const SubmitRun run = place.submit(port, {a, b});
  CHECK(run.code == 2);
  CHECK(run.errors.find(a) != std::string::npos);
  CHECK(run.errors.find("would both be part.glb") != std::string::npos);
  CHECK_FALSE(fs::exists(place.out()));
}

TEST_CASE("a wrong command line ends with 2") {
  const SubmitPlace place;
  const auto code = [&](const std::vector<std::string>& more) {
    return place.submit(1, place.write_meshes(1), more).code;
  };
  CHECK(SubmitProcess({}).wait().code == 2);
  CHECK(SubmitProcess({"--help"}).wait().code == 0);
  CHECK(code({"--params", "{"}) == 2);
  CHECK(code({"--params", "[]"}) == 2);
  CHECK(code({"--params", "@/no/such/file"}) == 2);
  CHECK(code({"--concurrency", "0"}) == 2);
  CHECK(code({"--label", "novalue"}) == 2);
  CHECK(SubmitProcess({"a.glb", "--server", "ftp://x", "--out", "/tmp"}).wait().code == 2);
  CHECK(SubmitProcess({"a.glb", "--server", "http://x", "--out", "/dev/null"}).wait().code == 2);
}
