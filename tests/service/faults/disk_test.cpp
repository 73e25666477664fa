// A disk that is full, or that takes nothing.
#include <fstream>
#include <optional>
#include <string>

#include <catch2/catch.hpp>

#include "tests/service/faults/own_mounts.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr std::size_t kMebibyte = std::size_t{1} << 20U;
constexpr const char* kType = "model/gltf-binary";

/// Takes what is left of a disk.
void fill(const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  const std::string block(4096, 'x');
  while (out.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
  }
}

/// Waits until the log has a line with this event.
void wait_for_line(const std::filesystem::path& log, const std::string& event) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    std::ifstream in(log);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.find("\"event\":\"" + event + "\"") != std::string::npos) return;
    CAPTURE(text);
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// A result that was there before, documents and lists are answered.
void check_reads(const HttpClient& client, const std::string& path) {
  CHECK(client.get(path).json()["state"] == "succeeded");
  CHECK(client.get(path + "/result").status == 200);
  CHECK(client.get("/v1/jobs").json()["jobs"].size() == 1);
  CHECK(client.get("/livez").status == 200);
}

}  // namespace

TEST_CASE("on a full disk nothing is accepted, reads go on, and room brings it back") {
  if (!enter_own_mounts()) return;
  const SmallDisk disk(8 * kMebibyte);
  const ServiceProcess service(disk.path(), {"--min-free", "0"});
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  fill(disk.path() / "filler");
  for (const char* to : {"/v1/jobs", "/v1/denoise", "/v1/inspect"}) {
    CAPTURE(to);
    const Answer answer = client.post(to, noisy_torus(60), kType);
    CHECK(answer.status == 507);
    CHECK(answer.problem() == "storage_full");
  }
  check_reads(client, path);
  CHECK(std::filesystem::is_empty(disk.path() / "spool"));
  std::filesystem::remove(disk.path() / "filler");
  const std::string after = submit(client, noisy_torus(60));
  CHECK(wait_until_final(client, after)["state"] == "succeeded");
}

TEST_CASE("a disk that fills up under a running job costs time, not the job") {
  if (!enter_own_mounts()) return;
  const SmallDisk disk(8 * kMebibyte);
  const TemporaryDirectory log;
  const ServiceProcess service(disk.path(), {"--min-free", "0", "--workers", "1", "--lease", "5"},
                               log.path() / "log");
  const HttpClient client = service.client();
  const std::string path = submit(client, noisy_torus(60), R"({"steps":2000})");
  wait_until_busy(client, path);
  fill(disk.path() / "filler");
  CHECK(client.post("/v1/jobs", noisy_torus(60), kType).status == 507);
  wait_for_line(log.path() / "log", "storage_failed");
  CHECK(client.get(path).json()["state"] != "failed");
  std::filesystem::remove(disk.path() / "filler");
  const Json job = wait_until_final(client, path);
  CAPTURE(job.dump());
  CHECK(job["state"] == "succeeded");
  CHECK(job["attempt"] == 1);
  CHECK(client.get(path + "/result").status == 200);
}

TEST_CASE("a spool that cannot be written refuses uploads, and nothing else") {
  if (!enter_own_mounts()) return;
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  auto lock = std::make_optional<ReadOnly>(directory.path() / "spool");
  const Answer answer = client.post("/v1/jobs", small_glb(), kType);
  CHECK(answer.status == 503);
  CHECK(answer.problem() == "unavailable");
  CHECK(answer.body.find("spool") == std::string::npos);
  CHECK_FALSE(answer.header("retry-after").empty());
  check_reads(client, path);
  CHECK(ask_until(client, "/readyz", 503)["checks"]["data"]["ok"] == false);
  lock.reset();
  CHECK(wait_until_final(client, submit(client, noisy_torus(20)))["state"] == "succeeded");
  CHECK(ask_until(client, "/readyz", 200)["checks"]["data"]["ok"] == true);
}
