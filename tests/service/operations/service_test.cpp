// The real service with the real worker, from outside.
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

#include <catch2/catch.hpp>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// Steps enough to be met at work, few enough to end.
const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";

bool is_glb(const std::string& body) {
  return body.size() > 12 && body.starts_with("glTF");
}

}  // namespace

TEST_CASE("a job goes from its upload to a denoised mesh") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(20);

  const std::string path = submit(client, mesh, R"({"steps":3})");
  const Json job = wait_until_final(client, path);
  CAPTURE(job.dump());
  REQUIRE(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
  CHECK(job["parameters"]["steps"] == 3);
  CHECK(job["input"]["bytes"] == mesh.size());
  CHECK(job["report"].is_object());

  const Answer result = client.get(path + "/result");
  CHECK(result.status == 200);
  CHECK(result.header("content-type") == "model/gltf-binary");
  CHECK(result.body.size() == job["result"]["bytes"]);
  CHECK(is_glb(result.body));
  CHECK(result.body != mesh);
  CHECK(result.body.find("_CURVATURE_MEAN") != std::string::npos);
}

TEST_CASE("the synchronous way answers with the mesh itself, raw and multipart") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(10);
  const std::string parameters = R"({"steps":2,"method":"mean_curvature"})";

  const Answer raw = client.post("/v1/denoise?params=" + percent_encoded(parameters), mesh);
  CAPTURE(raw.body.substr(0, 300));
  REQUIRE(raw.status == 200);
  CHECK(raw.header("content-type") == "model/gltf-binary");
  CHECK(is_glb(raw.body));
  const Answer form = client.post_form("/v1/denoise", mesh, "torus.glb", parameters);
  REQUIRE(form.status == 200);
  CHECK(form.body == raw.body);
  CHECK(client.get(form.header("location")).json()["state"] == "succeeded");
}

TEST_CASE("method none adds curvature and features and touches no position") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const std::string mesh = noisy_torus(10);
  const Answer answer = service.client().post(
      "/v1/denoise?params=" + percent_encoded(R"({"method":"none","features":true})"), mesh);
  REQUIRE(answer.status == 200);
  const auto json_of = [](const std::string& glb) {
    std::uint32_t size = 0;
    std::memcpy(&size, glb.data() + 12, sizeof size);
    return std::pair{Json::parse(glb.substr(20, size)), glb.substr(28 + size)};
  };
  const auto [before, old_bin] = json_of(mesh);
  const auto [after, bin] = json_of(answer.body);
  const Json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  const std::size_t position = before["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  CHECK(attributes["POSITION"] == position);
  CHECK(after["accessors"][position].dump() == before["accessors"][position].dump());
  CHECK(bin.substr(0, old_bin.size()) == old_bin);
  CHECK(attributes.contains("_CURVATURE_DIR2"));
  CHECK(attributes.contains("_FEATURE"));
}

TEST_CASE("a fixed vertex that the file does not have is a problem with its pointer") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const Answer answer = service.client().post(
      "/v1/denoise?params=" + percent_encoded(R"({"fixed_vertices":[0,99]})"), small_glb());
  CHECK(answer.status == 422);
  CHECK(answer.problem() == "invalid_parameters");
  CHECK(answer.json()["pointer"] == "/fixed_vertices/1");
}

TEST_CASE("five kinds of broken upload each get their problem") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const auto post = [&](const std::string& mesh, const std::string& query = "") {
    return client.post("/v1/denoise" + query, mesh, "model/gltf-binary");
  };
  const auto problem = [](const Answer& answer, int status) {
    CHECK(answer.status == status);
    return answer.problem();
  };
  CHECK(post(small_glb()).status == 200);
  CHECK(problem(post(small_glb(Flaw::truncated)), 400) == "malformed_input");
  CHECK(problem(post(small_glb(Flaw::index_out_of_range)), 422) == "invalid_mesh");
  CHECK(problem(post(small_glb(Flaw::not_a_number)), 422) == "invalid_mesh");
  CHECK(problem(post("\x89PNG\r\n\x1a\n" + std::string(100, 'x')), 415) == "unsupported_format");
  const Answer unknown = post(small_glb(), "?params=%7B%22stepz%22:1%7D");
  CHECK(problem(unknown, 422) == "invalid_parameters");
  CHECK(unknown.json()["pointer"] == "/stepz");
}

TEST_CASE("a failed job's result is its problem") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb(Flaw::not_a_number));
  const Json job = wait_until_final(client, path);
  CHECK(job["state"] == "failed");
  CHECK(job["attempt"] == 1);
  CHECK(job["problem"]["code"] == "invalid_mesh");
  const Answer result = client.get(path + "/result");
  CHECK(result.status == 422);
  CHECK(result.problem() == "invalid_mesh");
}

TEST_CASE("a request that cannot be met gets a problem that says why") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--max-body", "1000"});
  const HttpClient client = service.client();
  CHECK(client.get("/livez").status == 200);
  CHECK(client.get("/nowhere").problem() == "not_found");
  CHECK(client.get("/v1/jobs/AAAAAAAAAAAAAAAAAAAAAA").problem() == "not_found");
  CHECK(client.get("/v1/jobs/..%2F..%2Fetc%2Fpasswd").problem() == "not_found");

  const Answer put = client.put("/v1/jobs", "x");
  CHECK(put.problem() == "method_not_allowed");
  CHECK(put.header("allow") == "GET, HEAD, POST, OPTIONS");
  CHECK(client.get("/v1/denoise").header("allow") == "POST, OPTIONS");

  const Answer large = client.post("/v1/jobs", std::string(1001, 'x'), "model/gltf-binary");
  CHECK(large.status == 413);
  CHECK(large.problem() == "too_large");
  CHECK(large.header("connection") == "close");
  CHECK(client.post("/v1/jobs", "", "model/gltf-binary").problem() == "malformed_input");
  CHECK(client.raw("POST /v1/jobs HTTP/1.1\r\nHost: t\r\n\r\n").starts_with("HTTP/1.1 411 "));
  CHECK(client
            .raw("POST /v1/jobs HTTP/1.1\r\nHost: t\r\nContent-Encoding: gzip\r\n"
                 "Content-Length: 3\r\n\r\nabc")
            .starts_with("HTTP/1.1 415 "));
  CHECK(client.raw("BOGUS / HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 400 "));
  CHECK(client.get("/v1/jobs").json()["jobs"].empty());
}

TEST_CASE("what is refused leaves nothing behind") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  client.post("/v1/jobs", "not a mesh at all", "model/gltf-binary");
  client.post_form("/v1/jobs", small_glb(), "a.glb", R"({"stepz":1})");
  client.raw("POST /v1/jobs HTTP/1.1\r\nContent-Length: 500\r\n\r\nglTF\x02");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!std::filesystem::is_empty(directory.path() / "spool")) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(std::filesystem::is_empty(directory.path() / "blobs"));
  CHECK(client.get("/v1/jobs").json()["jobs"].empty());
}

TEST_CASE("pipelined requests are all answered, in one connection") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  std::string requests;
  for (int i = 0; i < 20; ++i) requests += "GET /livez HTTP/1.1\r\nHost: t\r\n\r\n";
  const std::string answers = service.client().raw(requests);
  std::size_t count = 0;
  for (std::size_t at = 0; (at = answers.find("HTTP/1.1 200", at)) != std::string::npos; ++at)
    ++count;
  CHECK(count == 20);
}

TEST_CASE("a running job is canceled and its worker is gone") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  const std::string path = submit(client, noisy_torus(300), kLong);
  wait_until_busy(client, path);
  CHECK(client.get(path + "/result").problem() == "not_ready");
  CHECK(service.workers().size() == 1);

  CHECK(client.post(path + "/cancel").json()["state"] == "canceled");
  CHECK(client.post(path + "/cancel").json()["state"] == "canceled");
  CHECK(client.get(path + "/result").problem() == "canceled");
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!service.workers().empty()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  // The slot is free again.
  CHECK(client.post("/v1/denoise", small_glb()).status == 200);
}

TEST_CASE("a deleted job has no result any more") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  CHECK(client.remove(path).json()["state"] == "expired");
  CHECK(client.remove(path).json()["state"] == "expired");
  const Answer result = client.get(path + "/result");
  CHECK(result.status == 410);
  CHECK(result.problem() == "gone");
  CHECK(std::filesystem::is_empty(directory.path() / "blobs"));
}

TEST_CASE("a full queue refuses at once and keeps nothing") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1", "--queue", "1"});
  const HttpClient client = service.client();
  const std::string running = submit(client, noisy_torus(300), kLong);
  wait_until_busy(client, running);
  const std::string waiting = submit(client, small_glb());
  const Answer refused = client.post("/v1/jobs", small_glb());
  CHECK(refused.status == 429);
  CHECK(refused.problem() == "queue_full");
  CHECK_FALSE(refused.header("retry-after").empty());
  CHECK(client.get("/v1/jobs").json()["jobs"].size() == 2);
  CHECK(client.get("/v1/jobs?state=queued").json()["jobs"].size() == 1);
  client.remove(running);
  CHECK(wait_until_final(client, waiting)["state"] == "succeeded");
}

TEST_CASE("a job that meets its deadline fails with the limit") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--deadline", "1"});
  const HttpClient client = service.client();
  const Answer answer = client.post("/v1/denoise?params=" + percent_encoded(kLong),
                                    noisy_torus(200), "model/gltf-binary");
  CHECK(answer.status == 422);
  CHECK(answer.problem() == "time_limit");
}

TEST_CASE("a taken port and a used data directory are refused at the start") {
  const TemporaryDirectory directory;
  const TemporaryDirectory other;
  const ServiceProcess service(directory.path());
  const Refusal used =
      refused_start({"--data", directory.path().string(), "--listen", "127.0.0.1:0"});
  CHECK(used.status.code == 36);
  CHECK(used.text.find("in use by another fairwayd") != std::string::npos);
  const Refusal taken = refused_start(
      {"--data", other.path().string(), "--listen", "127.0.0.1:" + std::to_string(service.port())});
  CHECK(taken.status.code == 36);
  CHECK(taken.text.find("listen on 127.0.0.1") != std::string::npos);
  CHECK(refused_start({"--what"}).status.code == 2);
}

TEST_CASE("the health of a service is asked for by the program itself") {
  const TemporaryDirectory directory;
  std::string address;
  {
    const ServiceProcess service(directory.path());
    address = "127.0.0.1:" + std::to_string(service.port());
    const Refusal healthy = refused_start({"--health", "--listen", address});
    CHECK(healthy.status.code == 0);
    std::filesystem::remove_all(directory.path() / "spool");
    const auto until = std::chrono::steady_clock::now() + kPatience;
    Refusal unready = healthy;
    while (unready.status.code == 0) {  // what it found stays found for a second
      REQUIRE(std::chrono::steady_clock::now() < until);
      unready = refused_start({"--health", "--listen", address});
    }
    CHECK(unready.status.code == 39);
    CHECK(unready.text.find("not ready") != std::string::npos);
  }
  const Refusal gone = refused_start({"--health", "--listen", address});
  CHECK(gone.status.code == 39);
  CHECK(gone.text.find("Nothing answers at " + address) != std::string::npos);
  CHECK(refused_start({"--health", "--listen", "127.0.0.1:0"}).status.code == 2);
}
