// A wall clock that somebody sets.
#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite.h"
#include "tests/service/faults/fault_folder.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr long kHour = 3600;

/// Seconds since 1970.
long created(const HttpClient& client, const std::string& path) {
  const std::string text = client.get(path).json()["created"];
  std::tm parts{};
  REQUIRE(::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts) != nullptr);
  return ::timegm(&parts);
}

/// Milliseconds of the clock that nobody can set.
std::int64_t uptime() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

/// Of the only job that runs, as uptime() counts.
std::int64_t lease_until(const std::filesystem::path& directory) {
  auto database = Database::open(directory / "jobs.sqlite");
  REQUIRE(database);
  auto query = database->query("SELECT lease_until FROM job WHERE state = 'running'");
  const auto row = query.step();
  REQUIRE(row);
  REQUIRE(*row);
  return query.integer(0);
}

}  // namespace

TEST_CASE("a clock that jumps by an hour takes no job from its worker") {
  const FaultFolder faults;
  const TemporaryDirectory directory;
  faults.set_clock(0);
  const ServiceProcess service(directory.path(), {"--workers", "1"}, {}, faults.environment());
  const HttpClient client = service.client();
  const std::string running = submit(client, noisy_torus(300), R"({"steps":10000})");
  const std::string queued = submit(client, noisy_torus(20));
  wait_until_busy(client, running);
  const auto workers = service.workers();
  REQUIRE(workers.size() == 1);
  const long before = created(client, running);
  for (const long ahead : {kHour, -kHour, kHour, 0L}) {
    CAPTURE(ahead);
    faults.set_clock(ahead);
    // The clock that jumped is the one that documents tell.
    const std::string late = submit(client, small_glb());
    const long seconds = created(client, late) - before;
    CHECK(seconds >= ahead);
    CHECK(seconds < ahead + 600);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const Json job = client.get(running).json();
    CAPTURE(job.dump());
    CHECK(job["state"] == "running");
    CHECK(job["attempt"] == 1);
    CHECK(service.workers() == workers);
    CHECK(client.get("/metrics").status == 200);
    const std::int64_t left = lease_until(directory.path()) - uptime();
    CHECK(left > 0);
    CHECK(left < 600'000);
  }
  CHECK(client.post(running + "/cancel").status == 200);
  CHECK(wait_until_final(client, queued)["state"] == "succeeded");
}
