// A job database that somebody else holds, or that is no longer there.
#include <future>
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kType = "model/gltf-binary";

void check_refused(const Answer& answer) {
  CHECK(answer.status == 503);
  CHECK(answer.problem() == "unavailable");
  CHECK_FALSE(answer.header("retry-after").empty());
}

}  // namespace

TEST_CASE("while the store is locked nothing is accepted, and reads do not wait for it") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  auto other = Database::open(directory.path() / "jobs.sqlite");
  REQUIRE(other);
  {
    const auto lock = Transaction::begin(*other);
    REQUIRE(lock);
    auto refused = std::async(
        std::launch::async, [&client] { return client.post("/v1/jobs", noisy_torus(20), kType); });
    // By order: these come back although the submit is still waiting for its turn.
    for (int i = 0; i < 20; ++i) {
      CHECK(client.get(path).json()["state"] == "succeeded");
      CHECK(client.get(path + "/result").status == 200);
      CHECK(client.get("/v1/jobs").json()["jobs"].size() == 1);
    }
    CHECK(refused.wait_for(std::chrono::seconds(0)) == std::future_status::timeout);
    check_refused(refused.get());
    CHECK(client.get("/v1/jobs").json()["jobs"].size() == 1);
    CHECK(std::filesystem::is_empty(directory.path() / "spool"));
  }
  CHECK(wait_until_final(client, submit(client, noisy_torus(20)))["state"] == "succeeded");
}

TEST_CASE("without the file of the store nothing is accepted, until it is back") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const auto file = directory.path() / "jobs.sqlite";
  const auto away = directory.path() / "away";
  std::filesystem::rename(file, away);
  check_refused(client.post("/v1/jobs", small_glb(), kType));
  check_refused(client.post("/v1/denoise", small_glb(), kType));
  CHECK(ask_until(client, "/readyz", 503)["checks"]["store"]["ok"] == false);
  CHECK(client.get("/livez").status == 200);
  CHECK(std::filesystem::is_empty(directory.path() / "blobs"));
  std::filesystem::rename(away, file);
  CHECK(wait_until_final(client, submit(client, small_glb()))["state"] == "succeeded");
  CHECK(ask_until(client, "/readyz", 200)["checks"]["store"]["ok"] == true);
}
