// What is promised when a process dies: the server, the worker, the client.
#include <csignal>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <sys/socket.h>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/sample_scene.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kSteps = R"({"method":"anisotropic_prescribed","steps":400})";
const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";

void kill_worker(const ServiceProcess& service) {
  const auto workers = service.workers();
  REQUIRE(workers.size() == 1);
  REQUIRE(::kill(workers.front(), SIGKILL) == 0);
}

}  // namespace

TEST_CASE("a job survives the death of its server right after the 202") {
  const TemporaryDirectory directory;
  const std::string mesh = noisy_torus(20);
  std::string path;
  {
    ServiceProcess service(directory.path());
    path = submit(service.client(), mesh, R"({"steps":5})");
    service.kill();
  }
  const ServiceProcess service(directory.path());
  const Json job = wait_until_final(service.client(), path);
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
  CHECK(service.client().get(path + "/result").status == 200);
}

TEST_CASE("a job of several files survives the death of its server, before and while it runs") {
  const TemporaryDirectory directory;
  const SampleScene scene(60);
  std::string path;
  Json accepted;
  for (int death = 0; death < 3; ++death) {
    ServiceProcess service(directory.path());
    const HttpClient client = service.client();
    if (path.empty()) {
      const Answer answer = client.post("/v1/jobs", form_body(scene.parts(kSteps)), kFormType);
      REQUIRE(answer.status == 202);
      path = answer.header("location");
      accepted = answer.json();
    } else {
      wait_until_busy(client, path);
    }
    service.kill();
  }
  const ServiceProcess service(directory.path());
  const Json job = wait_until_final(service.client(), path);
  CAPTURE(job.dump());
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
  CHECK(job["input"] == accepted["input"]);
  CHECK(job["input"]["files"] == 3);
  const Answer result = service.client().get(path + "/result");
  CHECK((result.body == denoised_by_tool(scene, "out.gltf", kSteps)));
}

TEST_CASE("a running job survives the death of its server, which is not counted") {
  const TemporaryDirectory directory;
  const std::string mesh = noisy_torus(60);
  std::string path;
  for (int death = 0; death < 3; ++death) {
    ServiceProcess service(directory.path());
    if (path.empty()) path = submit(service.client(), mesh, kSteps);
    wait_until_busy(service.client(), path);
    service.kill();
  }
  const ServiceProcess service(directory.path());
  const Json job = wait_until_final(service.client(), path);
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
}

TEST_CASE("a stopped server ends with 0 and hands its running job back") {
  const TemporaryDirectory directory;
  std::string path;
  {
    ServiceProcess service(directory.path(), {"--drain", "0"});
    path = submit(service.client(), noisy_torus(60), kSteps);
    wait_until_busy(service.client(), path);
    const ExitStatus status = service.stop();
    CHECK(status.code == 0);
    CHECK(status.signal == 0);
  }
  {
    auto store = SqliteJobStore::open(directory.path() / "jobs.sqlite");
    REQUIRE(store);
    CHECK((*store)->list({})->jobs.front().state == JobState::queued);
  }
  const ServiceProcess service(directory.path());
  const Json job = wait_until_final(service.client(), path);
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
}

TEST_CASE("one death of a worker ends with one retry and the same result") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(60);
  const std::string path = submit(client, mesh, kSteps);
  wait_until_busy(client, path);
  kill_worker(service);
  const Json job = wait_until_final(client, path);
  CAPTURE(job.dump());
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 2);
  // Work of its own, not the result that is there.
  const std::string undisturbed = client
                                      .post("/v1/jobs?params=" + percent_encoded(kSteps), mesh,
                                            "model/gltf-binary", {{"Cache-Control", "no-cache"}})
                                      .header("location");
  CHECK(wait_until_final(client, undisturbed)["result"]["sha256"] == job["result"]["sha256"]);
}

TEST_CASE("two deaths of a worker fail the job for good") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, noisy_torus(300), kLong);
  for (int attempt = 1; attempt <= 2; ++attempt) {
    follow(client, path, [&](const Json& job) {
      return job["state"] == "running" && job["attempt"] == attempt && job.contains("progress");
    });
    kill_worker(service);
  }
  const Json job = wait_until_final(client, path);
  CHECK(job["state"] == "failed");
  CHECK(job["problem"]["code"] == "worker_crashed");
  CHECK(client.get("/livez").status == 200);
}

TEST_CASE("a worker does not outlive its server") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path());
  const std::string path = submit(service.client(), noisy_torus(300), kLong);
  wait_until_busy(service.client(), path);
  const auto workers = service.workers();
  REQUIRE(workers.size() == 1);
  service.kill();
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (::kill(workers.front(), 0) == 0) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST_CASE("a synchronous job is canceled when its client hangs up") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(300);
  // raw() closes after two seconds without an answer.
  CHECK(client
            .raw("POST /v1/denoise?params=" + percent_encoded(kLong) +
                 " HTTP/1.1\r\nHost: t\r\nContent-Type: model/gltf-binary\r\nContent-Length: " +
                 std::to_string(mesh.size()) + "\r\n\r\n" + mesh)
            .empty());
  const Json jobs = client.get("/v1/jobs").json()["jobs"];
  REQUIRE(jobs.size() == 1);
  const std::string path = jobs[0]["links"]["self"];
  CHECK(wait_until_final(client, path)["state"] == "canceled");
}
