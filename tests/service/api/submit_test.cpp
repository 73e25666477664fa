// What a client may ask of a job beside its mesh, and that one submit is one job.
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "server/os/random_id.h"
#include "server/os/sha256.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kGlbType = "model/gltf-binary";
/// Long enough to be met at work.
const std::string kLong = "params=" + percent_encoded(R"({"steps":10000})");

std::string id_of(const Answer& answer) {
  CAPTURE(answer.body);
  REQUIRE((answer.status == 202 || answer.status == 200));
  return answer.json()["id"];
}

std::string sha256_of(const std::string& text) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(text)));
  return hash.hex();
}

}  // namespace

TEST_CASE("a retried submit with its Idempotency-Key finds the job of the first") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(10);
  const HttpClient::Headers key = {{"Idempotency-Key", "upload-7"}};
  const Answer first = client.post("/v1/jobs", mesh, kGlbType, key);
  CHECK(first.status == 202);
  const Answer again = client.post("/v1/jobs", mesh, kGlbType, key);
  CHECK(again.status == 200);
  CHECK(id_of(again) == id_of(first));
  CHECK(client.get("/v1/jobs").json()["jobs"].size() == 1);

  CHECK(client.post("/v1/jobs?priority=1", mesh, kGlbType, key).problem() == "key_reused");
  CHECK(client.post("/v1/jobs", small_glb(), kGlbType, key).problem() == "key_reused");
  CHECK(client.post("/v1/jobs", mesh, kGlbType, {{"Idempotency-Key", ""}}).status == 400);
  CHECK(id_of(client.post("/v1/jobs", mesh, kGlbType, {{"Idempotency-Key", "other"}})) !=
        id_of(first));
}

TEST_CASE("a key is in flight while its upload is") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const std::string mesh = small_glb();
  const auto submit_again = [&] {
    return service.client().post("/v1/jobs", mesh, kGlbType, {{"Idempotency-Key", "k"}});
  };
  RawConnection slow(service.port());
  slow.send("POST /v1/jobs HTTP/1.1\r\nHost: t\r\nContent-Length: " + std::to_string(mesh.size()) +
            "\r\nContent-Type: model/gltf-binary\r\nIdempotency-Key: k\r\n"
            "Expect: 100-continue\r\nConnection: close\r\n\r\n");
  slow.read_until("100 Continue\r\n\r\n");  // its body is waited for: it is on its way
  CHECK(submit_again().problem() == "conflict");
  slow.send(mesh);
  CHECK(slow.read_all().starts_with("HTTP/1.1 202 "));
  CHECK(submit_again().status == 200);
}

TEST_CASE("a key of one id is refused for another id") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const HttpClient::Headers key = {{"Idempotency-Key", "k"}};
  const auto put = [&](const std::string& id) {
    return client.put("/v1/jobs/" + id, small_glb(), kGlbType, key);
  };
  CHECK(put("a").status == 202);
  CHECK(put("a").status == 200);
  const Answer other = put("b");
  CHECK(other.status == 422);
  CHECK(other.problem() == "key_reused");
  CHECK(client.get("/v1/jobs/b").status == 404);
}

TEST_CASE("a repeated submit finds its job in a full queue, and a new one is refused") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1", "--queue", "2"});
  const HttpClient client = service.client();
  const std::string busy =
      client.post("/v1/jobs?" + kLong, noisy_torus(30), kGlbType).header("location");
  wait_until_busy(client, busy);
  const auto post = [&](const std::string& key) {
    return client.post("/v1/jobs", small_glb(), kGlbType, {{"Idempotency-Key", key}});
  };
  const auto put = [&](const std::string& id) {
    return client.put("/v1/jobs/" + id, small_glb(), kGlbType);
  };
  const std::string keyed = id_of(post("known"));
  CHECK(put("own").status == 202);
  CHECK(post("new").problem() == "queue_full");
  CHECK(put("other").problem() == "queue_full");
  CHECK(client.post("/v1/jobs", small_glb(), kGlbType).problem() == "queue_full");
  const Answer again = post("known");
  CHECK(again.status == 200);
  CHECK(id_of(again) == keyed);
  CHECK(put("own").status == 200);
  client.remove(busy);
}

TEST_CASE("a client may choose the id of its job") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(10);
  const Answer made = client.put("/v1/jobs/scan-0815_b", mesh, kGlbType);
  CHECK(made.status == 202);
  CHECK(made.header("location") == "/v1/jobs/scan-0815_b");
  CHECK(client.put("/v1/jobs/scan-0815_b", mesh, kGlbType).status == 200);
  const Answer other = client.put("/v1/jobs/scan-0815_b", small_glb(), kGlbType);
  CHECK(other.status == 409);
  CHECK(other.problem() == "conflict");
  CHECK(client.put("/v1/jobs/no%2Fpath", mesh, kGlbType).status == 404);
  CHECK(client.put("/v1/jobs/" + std::string(65, 'x'), mesh, kGlbType).status == 404);
  const Json job = wait_until_final(client, "/v1/jobs/scan-0815_b");
  CHECK(job["state"] == "succeeded");
  CHECK(client.get("/v1/jobs/scan-0815_b/result").status == 200);
}

TEST_CASE("a job has the options it was submitted with, from the query or from a part") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Json job = client
                       .post("/v1/jobs?label=batch:9&label=red&priority=4&ttl=600&deadline=30",
                             small_glb(), kGlbType)
                       .json();
  CHECK(job["labels"] == Json({"batch:9", "red"}));
  CHECK(job["priority"] == 4);
  CHECK(job["ttl"] == 600);
  CHECK(job["deadline"] == 30);
  const auto refused = [&](const std::string& query) {
    return client.post("/v1/jobs?" + query, small_glb(), kGlbType);
  };
  CHECK(refused("priority=11").json()["pointer"] == "/priority");
  CHECK(refused("ttl=5").problem() == "invalid_parameters");
  CHECK(refused("label=a%20b").problem() == "invalid_parameters");
  CHECK(refused("priority=1&priority=2").problem() == "bad_request");
  CHECK(refused("colour=red").problem() == "bad_request");
  CHECK(client.post("/v1/inspect?priority=1", small_glb(), kGlbType).problem() == "bad_request");
}

TEST_CASE("a batch is followed by its label") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  for (int i = 0; i < 3; ++i) {
    id_of(client.post("/v1/jobs?label=batch:1&params=" +
                          percent_encoded(R"({"steps":)" + std::to_string(i + 1) + "}"),
                      small_glb(), kGlbType));
  }
  id_of(client.post("/v1/jobs?label=batch:2", small_glb(), kGlbType));
  const Json all = client.get("/v1/jobs").json();
  REQUIRE(all["jobs"].size() == 4);
  for (const Json& job : all["jobs"]) {
    wait_until_final(client, "/v1/jobs/" + job["id"].get<std::string>());
  }
  const Json batch = client.get("/v1/jobs?label=batch:1&limit=2").json();
  CHECK(batch["jobs"].size() == 2);
  CHECK(batch["counts"]["succeeded"] == 3);
  CHECK(batch["counts"]["queued"] == 0);
  const Json rest =
      client.get("/v1/jobs?label=batch:1&cursor=" + batch["next"].get<std::string>()).json();
  CHECK(rest["jobs"].size() == 1);
  CHECK_FALSE(rest.contains("next"));
  CHECK(client.get("/v1/jobs?cursor=x").problem() == "bad_request");
}

TEST_CASE("the same work is not done twice, unless it is asked for") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(10);
  const std::string first = submit(client, mesh);
  const Json done = wait_until_final(client, first);
  REQUIRE(done["state"] == "succeeded");
  CHECK_FALSE(done.contains("cached"));

  const Answer again = client.post("/v1/jobs?label=again", mesh, kGlbType);
  CHECK(again.status == 200);
  CHECK(again.json()["cached"] == true);
  CHECK(again.json()["state"] == "succeeded");
  CHECK(again.json()["result"]["sha256"] == done["result"]["sha256"]);
  const std::string second = "/v1/jobs/" + id_of(again);
  CHECK(second != first);
  CHECK(client.remove(first).status == 200);
  CHECK(client.get(second + "/result").status == 200);

  CHECK(client.post("/v1/jobs", mesh, kGlbType, {{"Cache-Control", "no-cache"}}).status == 202);
  CHECK(
      client.post("/v1/jobs?params=" + percent_encoded(R"({"steps":1})"), mesh, kGlbType).status ==
      202);
}

TEST_CASE("a job may name an earlier input by its digest") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(10);
  const std::string first = submit(client, mesh);
  const std::string query = "/v1/jobs?input=sha256:" + sha256_of(mesh);
  const Answer answer = client.post(query + "&params=" + percent_encoded(R"({"steps":2})"));
  CHECK(answer.status == 202);
  const Json job = wait_until_final(client, answer.header("location"));
  CHECK(job["state"] == "succeeded");
  CHECK(job["input"]["sha256"] == sha256_of(mesh));
  wait_until_final(client, first);
  client.remove(first);
  CHECK(client.get(answer.header("location") + "/result").status == 200);
  client.remove(answer.header("location"));
  CHECK(client.post(query).problem() == "not_found");
  CHECK(client.post("/v1/jobs?input=md5:00").problem() == "bad_request");
}

TEST_CASE("a failed or canceled job is done again from the input that was kept") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer submitted = client.post("/v1/jobs?" + kLong, noisy_torus(20), kGlbType);
  const std::string path = submitted.header("location");
  CHECK(client.post(path + "/retry").problem() == "conflict");
  const Json canceled = client.post(path + "/cancel").json();
  CHECK(canceled["links"]["retry"] == path + "/retry");
  CHECK(canceled.contains("expires_at"));
  CHECK(client.post(path + "/retry").status == 202);
  wait_until_busy(client, path);
  CHECK(client.remove(path).json()["state"] == "expired");
  CHECK(client.remove(path).status == 200);
  CHECK(client.post(path + "/retry").status == 410);
}

TEST_CASE("meshes are kept as long as was asked for, and then swept") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--keep", "1"});
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  follow(client, path, [](const Json& job) { return job["state"] == "expired"; });
  CHECK(client.get(path + "/result").status == 410);
  // The row says so before the files go.
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!std::filesystem::is_empty(directory.path() / "blobs")) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST_CASE("a queued job tells its place in the queue") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  const std::string busy =
      client.post("/v1/jobs?" + kLong, noisy_torus(30), kGlbType).header("location");
  wait_until_busy(client, busy);
  const std::string first = submit(client, small_glb());
  const std::string urgent =
      client.post("/v1/jobs?priority=9", noisy_torus(10), kGlbType).header("location");
  CHECK(client.get(first).json()["queue_position"] == 2);
  CHECK(client.get(urgent).json()["queue_position"] == 1);
  client.remove(busy);
}
