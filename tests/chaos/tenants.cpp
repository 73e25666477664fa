// Two tenants who want all that there is.
#include <algorithm>
#include <array>
#include <future>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/fairwayd/store/sqlite_tenant_store.h"
#include "tests/chaos/arena.h"
#include "tests/chaos/crowd.h"
#include "tests/chaos/scenarios.h"
#include "tests/service/support/job_follower.h"

namespace fairway::chaos {
namespace {

constexpr std::size_t kJobs = 1000;
constexpr double kRefusalBound = 50.0;
/// Claims of one tenant after another while the other one waits. Two: who was idle comes back
/// before or behind the other.
constexpr std::size_t kMostInARow = 2;

/// One job's life as the documents tell it; the times sort as text.
struct Life {
  std::size_t tenant = 0;
  std::string created;
  std::string started;
};

/// A key, written where the service will look for it.
std::string make_key(const Arena& arena, const std::string& tenant) {
  auto store = SqliteTenantStore::open(arena.directory() / "jobs.sqlite");
  expect(static_cast<bool>(store), "the store of tenants cannot be opened");
  const auto scopes = parse_scopes("submit,read");
  const auto key = (*store)->add_key({tenant, *scopes, "", {}});
  expect(static_cast<bool>(key), "no key can be made");
  return *key;
}

/// A job of a tenant ended well and its result is the undisturbed one.
Life expect_result(const Arena& arena, const std::string& id, const std::string& sha256,
                   const test::HttpClient::Headers& headers) {
  const Json job = test::follow(
      arena.client(), path_of(id),
      [](const Json& each) { return each["state"] != "queued" && each["state"] != "running"; },
      headers);
  expect(job["state"] == "succeeded", fmt::format("job {} ended otherwise: {}", id, job.dump()));
  const test::Answer result = arena.client().get(path_of(id) + "/result", headers);
  expect(sha256_of(result.body) == sha256, fmt::format("the result of job {} is another", id));
  return {0, job["created"], job["started"]};
}

/// Jobs of one tenant start in the order in which they came, and while both wait the tenants take
/// turns.
void expect_fair(std::vector<Life> lives) {
  std::sort(lives.begin(), lives.end(),
            [](const Life& a, const Life& b) { return a.started < b.started; });
  std::array<std::string, 2> newest;
  std::size_t in_a_row = 0;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    const Life& life = lives[i];
    expect(newest.at(life.tenant) <= life.created, "a job overtook an older one of its tenant");
    newest.at(life.tenant) = life.created;
    const bool same = i > 0 && lives[i - 1].tenant == life.tenant;
    // Whether the other one has a job that was there when this one started.
    const bool other_waits = std::any_of(
        lives.begin() + static_cast<std::ptrdiff_t>(i), lives.end(),
        [&](const Life& l) { return l.tenant != life.tenant && l.created < life.started; });
    in_a_row = !other_waits ? 0 : same ? in_a_row + 1 : 1;
    expect(in_a_row <= kMostInARow,
           fmt::format("tenant {} had {} turns in a row", life.tenant, in_a_row));
  }
}

}  // namespace

void crowd(Trials& trials, Workshop& workshop, std::size_t count) {
  const std::vector<Work> kinds = kinds_of(workshop);
  const std::size_t jobs = trials.scaled(kJobs) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    trials.run(fmt::format("{} jobs from {} clients of two tenants", 2 * jobs, kClients), [&] {
      Arena arena(trials, {"--workers", "1", "--queue", "16", "--auth", "keys"});
      std::array<test::HttpClient::Headers, 2> headers;
      for (std::size_t tenant = 0; tenant < headers.size(); ++tenant) {
        headers.at(tenant) = kWorkOfItsOwn;
        headers.at(tenant).emplace("Authorization",
                                   "Bearer " + make_key(arena, fmt::format("tenant-{}", tenant)));
      }
      arena.start();
      std::vector<std::future<Told>> crowds;
      crowds.reserve(headers.size());
      for (const auto& each : headers) {
        crowds.push_back(std::async(std::launch::async, [&] {
          return Crowd(arena.client(), kinds, jobs).ask(kClients / 2, each);
        }));
      }
      std::vector<Life> lives;
      bool was_full = false;
      for (std::size_t tenant = 0; tenant < headers.size(); ++tenant) {
        const Told told = crowds.at(tenant).get();
        expect_accepted(told, jobs);
        was_full = was_full || !told.refusals.empty();
        trials.measure("queue-full answer", told.refusals, "ms", kRefusalBound);
        for (const auto& [id, sha256] : told.accepted) {
          lives.push_back(expect_result(arena, id, sha256, headers.at(tenant)));
          lives.back().tenant = tenant;
          arena.note_kept(id);
        }
      }
      expect(2 * jobs < kJobs || was_full, "the queue was never full");
      expect_fair(std::move(lives));
      arena.expect_clean_disk();
    });
  }
}

}  // namespace fairway::chaos
