// Health and metrics of the real service, from outside.
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "server/fairwayd/operations/canary.h"
#include "server/fairwayd/store/sqlite.h"
#include "tests/places.h"
#include "tests/service/support/changing_worker.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// The samples of a text of metrics by name with labels; fails the test where it is no such text.
std::map<std::string, double> samples_of(const Answer& answer) {
  REQUIRE(answer.status == 200);
  CHECK(answer.header("content-type") == "text/plain; version=0.0.4; charset=utf-8");
  std::map<std::string, double> samples;
  std::map<std::string, std::string> types;
  std::istringstream lines(answer.body);
  std::string family;
  for (std::string line; std::getline(lines, line);) {
    CAPTURE(line);
    if (line.starts_with("# TYPE ")) {
      family = line.substr(7, line.find(' ', 7) - 7);
      CHECK(types.emplace(family, line).second);
    } else if (!line.starts_with("# HELP ")) {
      CHECK(line.starts_with(family));
      const std::size_t space = line.rfind(' ');
      REQUIRE(space != std::string::npos);
      CHECK(samples.emplace(line.substr(0, space), std::stod(line.substr(space + 1))).second);
    }
  }
  CHECK(answer.body.ends_with('\n'));
  return samples;
}

/// Metrics once one of them has come to a value: some are counted after the client has its answer.
std::map<std::string, double> samples_until(const HttpClient& client, const std::string& name,
                                            double value) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    auto samples = samples_of(client.get("/metrics"));
    CAPTURE(name);
    if (samples.contains(name) && samples.at(name) >= value) return samples;
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string request_count(const std::string& labels) {
  return "fairway_http_requests_total{" + labels + "}";
}

}  // namespace

TEST_CASE("a service that can work is alive and ready") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const Answer alive = service.client().get("/livez");
  CHECK(alive.json() == Json{{"status", "alive"}});
  const Answer ready = service.client().get("/readyz");
  CHECK(ready.status == 200);
  CHECK(ready.header("cache-control") == "no-store");
  const Json document = ready.json();
  CHECK(document["status"] == "ready");
  CHECK(document["checks"].size() == 5);
  for (const char* check : {"store", "data", "disk", "worker", "sandbox"}) {
    CHECK(document["checks"][check]["ok"] == true);
  }
  CHECK(service.client().get("/readyz?canary=2").problem() == "bad_request");
  CHECK(service.client().post("/readyz").problem() == "method_not_allowed");
  CHECK(std::filesystem::is_empty(directory.path() / "spool"));
}

TEST_CASE("a canary goes through a worker and leaves nothing") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const Answer answer = service.client().get("/readyz?canary=1");
  CAPTURE(answer.body);
  CHECK(answer.status == 200);
  CHECK(answer.json()["checks"]["canary"]["ok"] == true);
  CHECK(std::filesystem::is_empty(directory.path() / "spool"));
  CHECK(std::filesystem::is_empty(directory.path() / "blobs"));
  CHECK(service.client().get("/v1/jobs").json()["jobs"].empty());
  // It is a mesh like any other.
  const Answer denoised = service.client().post("/v1/denoise", canary_glb());
  CHECK(denoised.status == 200);
}

TEST_CASE("a service whose worker does not start is alive and not ready, until it does") {
  const TemporaryDirectory directory;
  const ChangingWorker worker;
  const ServiceProcess service(directory.path(), {"--worker", worker.path()});
  const HttpClient client = service.client();
  CHECK(client.get("/readyz").status == 200);
  worker.become("exit 3");
  const Json document = ask_until(client, "/readyz", 503);
  CHECK(document["status"] == "not_ready");
  CHECK(document["checks"]["worker"]["ok"] == false);
  CHECK(document["checks"]["worker"]["detail"].is_string());
  CHECK(document["checks"]["store"]["ok"] == true);
  CHECK(client.get("/livez").status == 200);
  worker.become("exec " + program("fairway") + " \"$@\"");
  CHECK(ask_until(client, "/readyz", 200)["checks"]["worker"]["ok"] == true);
}

TEST_CASE("a worker that starts and cannot work is found by the canary") {
  const TemporaryDirectory directory;
  const ChangingWorker worker;
  worker.become("[ \"$1\" = --version ] || [ \"$2\" = --self-test-sandbox ]");
  const ServiceProcess service(directory.path(), {"--worker", worker.path()});
  CHECK(service.client().get("/readyz").status == 200);
  const Answer answer = service.client().get("/readyz?canary=1");
  CHECK(answer.status == 503);
  CHECK(answer.json()["checks"]["worker"]["ok"] == true);
  CHECK(answer.json()["checks"]["canary"]["ok"] == false);
}

TEST_CASE("a service whose sandbox does not hold is not ready, and logs what was let through") {
  const TemporaryDirectory directory;
  const ChangingWorker worker;
  const std::string tool = program("fairway");
  worker.become("[ \"$2\" = --self-test-sandbox ] && exec " + tool +
                " worker --self-test-unconfined\nexec " + tool + " \"$@\"");
  const auto log = directory.path() / "log";
  const ServiceProcess service(directory.path() / "data", {"--worker", worker.path()}, log);
  const Answer answer = service.client().get("/readyz");
  CHECK(answer.status == 503);
  CHECK(answer.json()["checks"]["worker"]["ok"] == true);
  CHECK(answer.json()["checks"]["sandbox"]["ok"] == false);
  std::ifstream file(log);
  const std::string said{std::istreambuf_iterator<char>(file), {}};
  CHECK(said.find("FAILED forbidden open a file") != std::string::npos);
}

TEST_CASE("asking for readiness does not start a worker every time") {
  const TemporaryDirectory directory;
  const ChangingWorker worker;
  const std::string count = worker.place("count");
  worker.become("echo x >> " + count);
  const ServiceProcess service(directory.path(), {"--worker", worker.path()});
  for (int i = 0; i < 50; ++i) CHECK(service.client().get("/readyz").status == 200);
  CHECK(std::filesystem::file_size(count) / 2 < 25);
}

TEST_CASE("a service whose data directory is lost is not ready, until it is back") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  std::filesystem::rename(directory.path() / "spool", directory.path() / "away");
  CHECK(ask_until(service.client(), "/readyz", 503)["checks"]["data"]["ok"] == false);
  CHECK(service.client().get("/livez").status == 200);
  std::filesystem::rename(directory.path() / "away", directory.path() / "spool");
  CHECK(ask_until(service.client(), "/readyz", 200)["checks"]["data"]["ok"] == true);
}

TEST_CASE("a service whose store cannot be written is not ready, until it can") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  auto other = Database::open(directory.path() / "jobs.sqlite");
  REQUIRE(other);
  {
    const auto lock = Transaction::begin(*other);
    REQUIRE(lock);
    CHECK(ask_until(service.client(), "/readyz", 503)["checks"]["store"]["ok"] == false);
    CHECK(service.client().get("/livez").status == 200);
  }
  CHECK(ask_until(service.client(), "/readyz", 200)["checks"]["store"]["ok"] == true);
}

TEST_CASE("with too little disk left uploads are refused before they are kept") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--min-free", "281474976710656"});
  const HttpClient client = service.client();
  CHECK(ask_until(client, "/readyz", 503)["checks"]["disk"]["ok"] == false);
  for (const char* path : {"/v1/jobs", "/v1/denoise", "/v1/inspect"}) {
    CAPTURE(path);
    const Answer answer = client.post(path, small_glb(), "model/gltf-binary");
    CHECK(answer.status == 507);
    CHECK(answer.problem() == "storage_full");
    CHECK(answer.body.find("281474976710656") == std::string::npos);
  }
  CHECK(client.get("/livez").status == 200);
  CHECK(client.get("/v1/jobs").json()["jobs"].empty());
  CHECK(std::filesystem::is_empty(directory.path() / "spool"));
}

TEST_CASE("metrics tell jobs, stages, workers and requests") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  CHECK(client.post("/v1/denoise", noisy_torus(10)).status == 200);
  CHECK(client.post("/v1/denoise", small_glb(Flaw::not_a_number)).status == 422);
  CHECK(client.post("/v1/inspect", small_glb()).status == 200);
  client.get("/nowhere/" + std::string(10, 'x'));
  client.raw("BOGUS / HTTP/1.1\r\n\r\n");
  client.raw("not http\r\n\r\n");
  for (const char* labels : {R"(route="/v1/denoise",method="POST",status="2xx")",
                             R"(route="/v1/denoise",method="POST",status="4xx")",
                             R"(route="none",method="GET",status="4xx")"}) {
    samples_until(client, request_count(labels), 1);
  }
  samples_until(client, "fairway_job_duration_seconds_count", 2);
  const auto samples =
      samples_until(client, request_count(R"(route="none",method="other",status="4xx")"), 2);
  CHECK(samples.at("fairway_jobs{state=\"succeeded\"}") == 1);
  CHECK(samples.at("fairway_jobs{state=\"failed\"}") == 1);
  CHECK(samples.at("fairway_jobs{state=\"queued\"}") == 0);
  CHECK(samples.at("fairway_queue_depth") == 0);
  CHECK(samples.at("fairway_queue_oldest_age_seconds") == 0);
  CHECK(samples.at("fairway_jobs_ended_total{outcome=\"succeeded\"}") == 1);
  CHECK(samples.at("fairway_jobs_ended_total{outcome=\"invalid_mesh\"}") == 1);
  CHECK(samples.at("fairway_job_duration_seconds_count") == 2);
  CHECK(samples.at("fairway_run_duration_seconds_count") == 1);
  double stages = 0;
  for (const char* stage : {"decode", "topology", "flow", "curvature", "encode"}) {
    const std::string label = "{stage=\"" + std::string(stage) + "\"}";
    CHECK(samples.at("fairway_stage_duration_seconds_count" + label) == 1);
    stages += samples.at("fairway_stage_duration_seconds_sum" + label);
  }
  CHECK(stages > 0);
  CHECK(stages <= samples.at("fairway_run_duration_seconds_sum"));
  CHECK(samples.at("fairway_inspections_total{outcome=\"succeeded\"}") == 1);
  CHECK(samples.at("fairway_worker_peak_resident_bytes_count") == 3);
  CHECK(samples.at("fairway_worker_peak_resident_bytes_sum") > 3e6);
  CHECK(samples.at("fairway_build_info{version=\"0.1.0\"}") == 1);
  CHECK(samples.at("fairway_storage_free_bytes") > 0);
  const auto requests = [&](const std::string& labels) {
    return samples.at(request_count(labels));
  };
  CHECK(requests(R"(route="/v1/denoise",method="POST",status="2xx")") == 1);
  CHECK(requests(R"(route="/v1/denoise",method="POST",status="4xx")") == 1);
  CHECK(requests(R"(route="none",method="GET",status="4xx")") == 1);
  CHECK(requests(R"(route="none",method="other",status="4xx")") == 2);
  CHECK(samples.at("fairway_http_request_duration_seconds_count{route=\"/v1/denoise\"}") == 2);
  CHECK(samples.at("fairway_http_received_bytes_total") > 2000);
  CHECK(samples.at("fairway_http_sent_bytes_total") > 2000);
  CHECK(samples.at("fairway_http_connections") >= 1);
}

TEST_CASE("metrics tell canceled jobs once, and a queue that waits") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  const std::string running = submit(client, noisy_torus(300), R"({"steps":10000})");
  wait_until_busy(client, running);
  const std::string waiting = submit(client, small_glb());
  auto samples = samples_of(client.get("/metrics"));
  CHECK(samples.at("fairway_queue_depth") == 1);
  CHECK(samples.at("fairway_jobs{state=\"running\"}") == 1);
  CHECK_FALSE(samples.contains("fairway_jobs_ended_total{outcome=\"canceled\"}"));
  for (int i = 0; i < 2; ++i) {
    CHECK(client.post(waiting + "/cancel").status == 200);
    CHECK(client.post(running + "/cancel").status == 200);
  }
  samples = samples_of(client.get("/metrics"));
  CHECK(samples.at("fairway_jobs_ended_total{outcome=\"canceled\"}") == 2);
  CHECK(samples.at("fairway_queue_depth") == 0);
}

TEST_CASE("a listener for administration takes the metrics over, and no work") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--admin-listen", "127.0.0.1:0"});
  const HttpClient main = service.client();
  const HttpClient admin(service.admin_port());
  CHECK(main.get("/metrics").problem() == "not_found");
  CHECK(main.get("/livez").status == 200);
  CHECK(main.get("/readyz").status == 200);
  CHECK(main.post("/v1/denoise", small_glb()).status == 200);
  CHECK(admin.get("/livez").status == 200);
  CHECK(admin.get("/readyz").status == 200);
  CHECK(admin.get("/v1/jobs").problem() == "not_found");
  CHECK(admin.post("/v1/denoise", small_glb()).problem() == "not_found");
  samples_until(admin, request_count(R"(route="/v1/denoise",method="POST",status="2xx")"), 1);
}

TEST_CASE("a taken port for administration is refused at the start") {
  const TemporaryDirectory directory;
  const TemporaryDirectory other;
  const ServiceProcess service(directory.path());
  const std::string taken = "127.0.0.1:" + std::to_string(service.port());
  const Refusal refusal = refused_start(
      {"--data", other.path().string(), "--listen", "127.0.0.1:0", "--admin-listen", taken});
  CHECK(refusal.status.code == 36);
  CHECK(refusal.text.find("listen on " + taken) != std::string::npos);
}
