// The real service with keys: who gets in, whose jobs are whose, and what each may take.
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "server/fairwayd/commands/tenant_command.h"
#include "server/fairwayd/store/access.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kGlbType = "model/gltf-binary";
const std::string kLong = "params=" + percent_encoded(R"({"steps":10000})");

/// Runs `fairwayd keys …` or `tenants …` and returns what it prints.
std::string command(const TemporaryDirectory& directory, std::vector<std::string> words) {
  words.insert(words.end(), {"--data", directory.path()});
  std::vector<const char*> arguments;
  arguments.reserve(words.size());
  for (const std::string& word : words) arguments.push_back(word.c_str());
  const auto text = run_tenant_command(arguments, {});
  REQUIRE(text);
  return *text;
}

std::string make_key(const TemporaryDirectory& directory, const std::string& tenant,
                     const std::string& scopes = "submit,read") {
  std::string text =
      command(directory, {"keys", "add", "--tenant", tenant, "--scopes", scopes, "--label", "t"});
  REQUIRE(text.ends_with('\n'));
  text.pop_back();
  return text;
}

HttpClient::Headers with(const std::string& key) {
  return {{"Authorization", "Bearer " + key}};
}

}  // namespace

TEST_CASE("with keys nothing but health is open") {
  const TemporaryDirectory directory;
  const std::string key = make_key(directory, "acme");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  CHECK(client.get("/livez").status == 200);
  CHECK(client.get("/readyz").status == 200);
  const Answer refused = client.get("/v1/jobs");
  CHECK(refused.status == 401);
  CHECK(refused.problem() == "unauthorized");
  CHECK(refused.header("www-authenticate") == "Bearer realm=\"fairway\"");
  CHECK(client.post("/v1/jobs", small_glb(), kGlbType).status == 401);
  CHECK(client.post("/v1/denoise", small_glb(), kGlbType).status == 401);
  CHECK(client.post("/v1/inspect", small_glb(), kGlbType).status == 401);
  CHECK(client.get("/metrics").status == 401);
  CHECK(client.get("/metrics", with(key)).status == 403);
  CHECK(client.get("/v1/jobs", with(key)).status == 200);
  CHECK(client.post("/v1/jobs", small_glb(), kGlbType, with(key)).status == 202);
  // Unknown paths stay unknown, with a key or without.
  CHECK(client.get("/v1/none").status == 404);
}

TEST_CASE("a refused upload is refused before it is sent") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const std::string answer = service.client().raw(
      "POST /v1/jobs HTTP/1.1\r\nHost: t\r\nContent-Length: 1000000\r\nExpect: 100-continue\r\n"
      "Content-Type: model/gltf-binary\r\n\r\n");
  CHECK(answer.starts_with("HTTP/1.1 401"));
}

TEST_CASE("a key does what its scopes say") {
  const TemporaryDirectory directory;
  const std::string reader = make_key(directory, "acme", "read");
  const std::string writer = make_key(directory, "acme", "submit");
  const std::string admin = make_key(directory, "acme", "admin");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  CHECK(client.post("/v1/jobs", small_glb(), kGlbType, with(reader)).problem() == "forbidden");
  const Answer made = client.post("/v1/jobs", small_glb(), kGlbType, with(writer));
  CHECK(made.status == 202);
  const std::string path = made.header("location");
  CHECK(client.get(path, with(writer)).status == 403);
  CHECK(client.get(path, with(reader)).status == 200);
  CHECK(client.post(path + "/cancel", "", kGlbType, with(reader)).status == 403);
  CHECK(client.get(path, with(admin)).status == 200);
  CHECK(client.get("/metrics", with(admin)).status == 200);
}

TEST_CASE("jobs of one tenant are not there for another") {
  const TemporaryDirectory directory;
  const std::string mine = make_key(directory, "mine");
  const std::string theirs = make_key(directory, "theirs");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  const Answer made = client.post("/v1/jobs?" + kLong, noisy_torus(20), kGlbType, with(mine));
  REQUIRE(made.status == 202);
  const std::string path = made.header("location");
  for (const char* part : {"", "/result", "/events"}) {
    CHECK(client.get(path + part, with(theirs)).status == 404);
  }
  for (const char* part : {"/cancel", "/retry"}) {
    CHECK(client.post(path + part, "", kGlbType, with(theirs)).status == 404);
  }
  CHECK(client.get("/v1/jobs", with(theirs)).json()["jobs"].empty());
  CHECK(client.get("/v1/jobs", with(mine)).json()["jobs"].size() == 1);
  CHECK(client.post(path + "/cancel", "", kGlbType, with(mine)).json()["state"] == "canceled");
}

TEST_CASE("two tenants may use one id, and each has its own result") {
  const TemporaryDirectory directory;
  const std::string mine = make_key(directory, "mine");
  const std::string theirs = make_key(directory, "theirs");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  const std::string path = "/v1/jobs/scan-1";
  const auto result_of = [&](const std::string& key, int ring) {
    REQUIRE(client.put(path, noisy_torus(ring), kGlbType, with(key)).status == 202);
    const auto is_over = [](const Json& job) { return job["state"] == "succeeded"; };
    follow(client, path, is_over, with(key));
    return client.get(path + "/result", with(key)).body;
  };
  const std::string first = result_of(mine, 10);
  const std::string second = result_of(theirs, 12);
  CHECK((first != second));
  CHECK((client.get(path + "/result", with(mine)).body == first));
  CHECK((client.get(path + "/result", with(theirs)).body == second));
}

TEST_CASE("equal work of another tenant is not found out") {
  const TemporaryDirectory directory;
  const std::string mine = make_key(directory, "mine");
  const std::string theirs = make_key(directory, "theirs");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  const std::string mesh = small_glb();
  REQUIRE(client.post("/v1/denoise", mesh, kGlbType, with(mine)).status == 200);
  CHECK(client.post("/v1/jobs", mesh, kGlbType, with(mine)).json()["cached"] == true);
  CHECK_FALSE(client.post("/v1/jobs", mesh, kGlbType, with(theirs)).json().contains("cached"));
}

TEST_CASE("a key that is revoked opens nothing from then on, while the service runs") {
  const TemporaryDirectory directory;
  const std::string key = make_key(directory, "acme");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const HttpClient client = service.client();
  REQUIRE(client.get("/v1/jobs", with(key)).status == 200);
  const std::string id = parse_key_text(key)->id;
  CHECK(command(directory, {"keys", "revoke", id}).find("revoked") != std::string::npos);
  CHECK(client.get("/v1/jobs", with(key)).status == 401);
  CHECK(command(directory, {"keys", "list"}).find(id) != std::string::npos);
  CHECK(command(directory, {"keys", "list", "--json"}).find(key) == std::string::npos);
  const std::string later = make_key(directory, "acme");
  CHECK(client.get("/v1/jobs", with(later)).status == 200);
}

TEST_CASE("a service without keys is refused to listen beyond its machine") {
  const TemporaryDirectory directory;
  const Refusal refusal = refused_start({"--data", directory.path(), "--listen", "0.0.0.0:0"});
  CHECK(refusal.status.code == 2);
  CHECK(refusal.text.find("--auth keys") != std::string::npos);
  const ServiceProcess open(directory.path(), {"--listen", "0.0.0.0:0", "--auth", "none"});
  CHECK(open.client().get("/v1/jobs").status == 200);
}

TEST_CASE("a tenant has only so many jobs waiting, and others still come in") {
  const TemporaryDirectory directory;
  const std::string mine = make_key(directory, "mine");
  const std::string theirs = make_key(directory, "theirs");
  command(directory, {"tenants", "set", "mine", "--most-queued", "1"});
  const ServiceProcess service(directory.path(), {"--auth", "keys", "--workers", "1"});
  const HttpClient client = service.client();
  const auto submit_as = [&](const std::string& key, int ring) {
    return client.post("/v1/jobs?" + kLong, noisy_torus(ring), kGlbType, with(key));
  };
  const std::string busy = submit_as(theirs, 40).header("location");
  follow(
      client, busy, [](const Json& job) { return job["state"] == "running"; }, with(theirs));
  CHECK(submit_as(mine, 10).status == 202);
  const Answer refused = submit_as(mine, 11);
  CHECK(refused.status == 429);
  CHECK(refused.problem() == "queue_full");
  CHECK_FALSE(refused.header("retry-after").empty());
  CHECK(submit_as(theirs, 12).status == 202);
}

TEST_CASE("a tenant keeps only so much") {
  const TemporaryDirectory directory;
  const std::string mesh = noisy_torus(10);
  const ServiceProcess service(directory.path(), {"--quota", std::to_string(mesh.size() + 10)});
  const HttpClient client = service.client();
  const Answer first = client.post("/v1/jobs?" + kLong, mesh, kGlbType);
  REQUIRE(first.status == 202);
  const Answer refused = client.post("/v1/jobs", mesh + " ", kGlbType);
  CHECK(refused.status == 507);
  CHECK(refused.problem() == "quota_exceeded");
  client.remove(first.header("location"));
  CHECK(client.post("/v1/jobs?" + kLong, mesh, kGlbType).status == 202);
}

TEST_CASE("submits are limited by the minute, and told how many are left") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--rate", "2"});
  const HttpClient client = service.client();
  const Answer first = client.post("/v1/jobs", small_glb(), kGlbType);
  CHECK(first.status == 202);
  CHECK(first.header("ratelimit-policy") == "\"queue\";q=256, \"submits\";q=2;w=60");
  CHECK(first.header("ratelimit").find("\"submits\";r=1;") != std::string::npos);
  CHECK(client.post("/v1/inspect", small_glb(), kGlbType).status == 200);
  const Answer refused = client.post("/v1/jobs", small_glb(), kGlbType);
  CHECK(refused.status == 429);
  CHECK(refused.problem() == "rate_limited");
  CHECK(std::stoi(refused.header("retry-after")) >= 1);
  CHECK(client.get(first.header("location")).status == 200);
}

TEST_CASE("a mesh that no worker could hold is refused with what it would need") {
  const TemporaryDirectory directory;
  const std::string mesh = noisy_torus(20);
  const ServiceProcess service(directory.path(),
                               {"--worker-memory", std::to_string(mesh.size() - 1)});
  const Answer refused = service.client().post("/v1/jobs", mesh, kGlbType);
  CHECK(refused.status == 413);
  CHECK(refused.problem() == "too_large");
  CHECK(refused.json()["detail"].get<std::string>().find(std::to_string(mesh.size())) !=
        std::string::npos);
  CHECK(std::filesystem::is_empty(directory.path() / "blobs"));
}

TEST_CASE("pages of other sites are kept out, and those on the list let in") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--cors-origins", "https://app.example"});
  const HttpClient client = service.client();
  const auto post = [&](const std::string& origin) {
    return client.post("/v1/jobs", small_glb(), kGlbType, {{"Origin", origin}});
  };
  CHECK(post("https://evil.example").problem() == "forbidden");
  const Answer allowed = post("https://app.example");
  CHECK(allowed.status == 202);
  CHECK(allowed.header("access-control-allow-origin") == "https://app.example");
  const std::string preflight = client.raw(
      "OPTIONS /v1/jobs HTTP/1.1\r\nHost: t\r\nOrigin: https://app.example\r\n"
      "Access-Control-Request-Method: POST\r\nConnection: close\r\n\r\n");
  CHECK(preflight.starts_with("HTTP/1.1 204"));
  CHECK(preflight.find("Access-Control-Allow-Methods: GET, HEAD, POST, OPTIONS") !=
        std::string::npos);
}
