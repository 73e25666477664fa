// The contract of Outbox beside a JobStore. Every implementation is put through the same cases.
#include <memory>
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kRoom = 100;

class Fixture {
 public:
  Fixture() { reopen(); }

  void reopen() {
    store_.reset();
    outbox_.reset();
    auto store = SqliteJobStore::open(path());
    auto outbox = SqliteOutbox::open(path());
    REQUIRE((store && outbox));
    store_ = *std::move(store);
    outbox_ = *std::move(outbox);
  }
  std::filesystem::path path() const { return directory_.path() / "jobs.sqlite"; }
  JobStore& store() { return *store_; }
  Outbox& outbox() { return *outbox_; }

  Job submit(const std::string& url = "https://example.com/hook?token=t") {
    NewJob job;
    job.name.id = random_id();
    job.input = {"in-" + job.name.id, 10, "aa"};
    job.parameters = "{}";
    job.trace_id = "trace";
    if (!url.empty()) job.options.webhook = Webhook{url};
    return submit(job);
  }
  Job submit(const NewJob& job) {
    auto submitted = store().submit(job, {kRoom});
    REQUIRE(submitted);
    return submitted->job;
  }
  /// The oldest queued job succeeds.
  void succeed() {
    auto claim = store().claim("host", 1min);
    REQUIRE((claim && *claim));
    const Success success{{"out-" + (*claim)->job.id, 20, "bb"}, Format::glb, R"({"steps":3})"};
    REQUIRE(store().finish((*claim)->lease, success));
  }
  std::optional<DeliveryClaim> claim(std::chrono::milliseconds lease = 1min,
                                     const BusyEndpoints& busy = {}) {
    auto claim = outbox().claim("host", lease, busy);
    REQUIRE(claim);
    return *claim;
  }
  std::vector<Delivery> list(const Job& job) {
    auto list = outbox().list(job.number);
    REQUIRE(list);
    return *list;
  }
  Delivery newest(const Job& job) {
    const auto deliveries = list(job);
    REQUIRE_FALSE(deliveries.empty());
    return deliveries.front();
  }
  OutboxCounts counts() {
    auto counts = outbox().counts();
    REQUIRE(counts);
    return *counts;
  }

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<JobStore> store_;
  std::unique_ptr<Outbox> outbox_;
};

DeliveryOutcome outcome(DeliveryState state, UnixMillis next_at = 0) {
  return {{wall_clock(), 7ms, 500, ""}, state, next_at};
}

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

}  // namespace

TEST_CASE("the end of a job makes one delivery, together with the state") {
  Fixture f;
  const Job job = f.submit();
  CHECK(f.list(job).empty());
  f.succeed();
  f.reopen();
  const auto deliveries = f.list(job);
  REQUIRE(deliveries.size() == 1);
  const Delivery& delivery = deliveries.front();
  CHECK(delivery.id.starts_with("msg_"));
  CHECK(delivery.event == "job.succeeded");
  CHECK(delivery.url == "https://example.com/hook?token=t");
  CHECK(delivery.state == DeliveryState::pending);
  CHECK(delivery.next_at <= wall_clock());
  const auto payload = parse_json(delivery.payload);
  REQUIRE(payload);
  CHECK((*payload)["data"]["id"] == job.id);
  CHECK((*payload)["data"]["revision"] == 3);
  CHECK((*payload)["data"]["result"]["sha256"] == "bb");
  // A cancel that comes too late changes nothing.
  REQUIRE(f.store().cancel({.id = job.id}));
  CHECK(f.list(job).size() == 1);
}

TEST_CASE("failed and canceled jobs are told, too, and jobs without a webhook are not") {
  Fixture f;
  const Job failed = f.submit();
  const auto claim = f.store().claim("host", 1min);
  REQUIRE((claim && *claim));
  REQUIRE(f.store().finish((*claim)->lease, Error{ErrorCode::no_triangles, "None."}));
  CHECK(f.newest(failed).event == "job.failed");
  const Job canceled = f.submit();
  REQUIRE(f.store().cancel({.id = canceled.id}));
  CHECK(f.newest(canceled).event == "job.canceled");
  // Done again, it ends again.
  REQUIRE(f.store().retry({.id = canceled.id}, kRoom));
  CHECK(f.list(canceled).size() == 1);
  f.succeed();
  REQUIRE(f.list(canceled).size() == 2);
  CHECK(f.newest(canceled).event == "job.succeeded");
  const Job silent = f.submit("");
  f.succeed();
  CHECK(f.list(silent).empty());
  CHECK(f.counts().pending == 3);
}

TEST_CASE("a job that has its result from another one is told at once") {
  Fixture f;
  NewJob job;
  job.input = {"in", 10, "aa"};
  job.parameters = "{}";
  job.content = "content";
  job.name.id = "first";
  f.submit(job);
  f.succeed();
  job.name.id = "second";
  job.options.webhook = Webhook{"https://example.com/"};
  const Job cached = f.submit(job);
  CHECK(cached.cached);
  REQUIRE(f.list(cached).size() == 1);
  CHECK(f.newest(cached).event == "job.succeeded");
}

TEST_CASE("a due delivery is claimed once, with what it takes to send it") {
  Fixture f;
  const Job job = f.submit();
  CHECK_FALSE(f.claim());
  f.succeed();
  const auto claim = f.claim();
  REQUIRE(claim);
  CHECK(claim->job_id == job.id);
  CHECK(claim->trace_id == "trace");
  CHECK(claim->tenant == kLocalTenant);
  CHECK(claim->origin == "https://example.com");
  CHECK(claim->delivery.id == f.newest(job).id);
  CHECK_FALSE(f.claim());
}

TEST_CASE("a lease that ran out, was given back or was its dead owner's is claimed anew") {
  Fixture f;
  f.submit();
  f.succeed();
  const auto first = f.claim(-1ms);
  const auto second = f.claim(1min);
  REQUIRE((first && second));
  CHECK(second->lease.fence > first->lease.fence);
  CHECK(refusal(f.outbox().record(first->lease, outcome(DeliveryState::delivered))) ==
        ErrorCode::conflict);
  CHECK(refusal(f.outbox().give_back(first->lease)) == ErrorCode::conflict);
  CHECK_FALSE(f.claim());
  REQUIRE(f.outbox().give_back(second->lease));
  REQUIRE(f.claim());
  f.reopen();
  CHECK_FALSE(f.claim());
  CHECK(*f.outbox().release("another") == 0);
  CHECK(*f.outbox().release("host") == 1);
  const auto last = f.claim();
  REQUIRE(last);
  CHECK(last->delivery.id == first->delivery.id);
  CHECK(last->delivery.attempt == 0);
}

TEST_CASE("an attempt is kept, and the next one comes in its time") {
  Fixture f;
  const Job job = f.submit();
  f.succeed();
  const UnixMillis later = wall_clock() + 3'600'000;
  REQUIRE(f.outbox().record(f.claim()->lease, outcome(DeliveryState::pending, later)));
  CHECK_FALSE(f.claim());
  const Delivery waiting = f.newest(job);
  CHECK(waiting.attempt == 1);
  CHECK(waiting.next_at == later);
  REQUIRE(waiting.attempts.size() == 1);
  CHECK(waiting.attempts.front().status == 500);
  CHECK(waiting.attempts.front().took == 7ms);
  CHECK(f.counts().oldest_pending == waiting.created);

  REQUIRE(f.outbox().redeliver(job.number, waiting.id));
  const auto again = f.claim();
  REQUIRE(again);
  DeliveryOutcome silent{{wall_clock(), 1ms, {}, "No answer came in time."}, DeliveryState::dead};
  REQUIRE(f.outbox().record(again->lease, silent));
  CHECK(refusal(f.outbox().record(again->lease, silent)) == ErrorCode::conflict);
  const Delivery dead = f.newest(job);
  CHECK(dead.state == DeliveryState::dead);
  CHECK_FALSE(dead.next_at);
  REQUIRE(dead.attempts.size() == 2);
  CHECK_FALSE(dead.attempts.back().status);
  CHECK(dead.attempts.back().error == "No answer came in time.");
  CHECK(f.counts().pending == 0);
}

TEST_CASE("a delivery is made due anew whatever its state, and only its own job's") {
  Fixture f;
  const Job job = f.submit();
  const Job other = f.submit();
  f.succeed();
  const std::string id = f.newest(job).id;
  for (const DeliveryState state : {DeliveryState::delivered, DeliveryState::dead}) {
    REQUIRE(f.outbox().record(f.claim()->lease, outcome(state)));
    CHECK(f.newest(job).delivered.has_value() == (state == DeliveryState::delivered));
    const auto again = f.outbox().redeliver(job.number, id);
    REQUIRE(again);
    CHECK(again->state == DeliveryState::pending);
    CHECK(again->attempt == 0);
    CHECK_FALSE(again->delivered);
  }
  CHECK(f.newest(job).attempts.size() == 2);
  CHECK(refusal(f.outbox().redeliver(other.number, id)) == ErrorCode::not_found);
  CHECK(refusal(f.outbox().redeliver(job.number, "msg_x")) == ErrorCode::not_found);
}

TEST_CASE("what goes to busy endpoints, or comes from busy tenants, is left aside") {
  Fixture f;
  f.submit("https://slow.example/a");
  f.submit("https://fast.example/b");
  f.succeed();
  f.succeed();
  const auto fast = f.claim(1min, {.origins = {"https://slow.example"}});
  REQUIRE(fast);
  CHECK(fast->origin == "https://fast.example");
  CHECK_FALSE(f.claim(1min, {.tenants = {std::string(kLocalTenant)}}));
  CHECK(f.claim()->origin == "https://slow.example");
}

TEST_CASE("the log of a delivery keeps its last attempts") {
  Fixture f;
  const Job job = f.submit();
  f.succeed();
  for (std::size_t i = 0; i < kMaxAttemptsKept + 3; ++i) {
    DeliveryOutcome late = outcome(DeliveryState::pending);
    late.attempt.at = static_cast<UnixMillis>(i);
    REQUIRE(f.outbox().record(f.claim()->lease, late));
  }
  const auto attempts = f.newest(job).attempts;
  REQUIRE(attempts.size() == kMaxAttemptsKept);
  CHECK(attempts.front().at == 3);
}

TEST_CASE("a delivery outlives the payload of its job and goes with the job") {
  Fixture f;
  const Job job = f.submit();
  f.succeed();
  REQUIRE(f.store().expire({.id = job.id}));
  CHECK(f.list(job).size() == 1);
  const auto claim = f.claim();
  REQUIRE(claim);
  REQUIRE(*f.store().forget(wall_clock() + 1000) == 1);
  CHECK(f.list(job).empty());
  CHECK(refusal(f.outbox().record(claim->lease, outcome(DeliveryState::delivered))) ==
        ErrorCode::conflict);
}

TEST_CASE("a tenant's secret is made once, and after a change the old one is in force for a day") {
  Fixture f;
  const auto first = f.outbox().secrets(kLocalTenant);
  REQUIRE(first);
  REQUIRE(first->size() == 1);
  f.reopen();
  CHECK(*f.outbox().secrets(kLocalTenant) == *first);
  const auto rotated = f.outbox().rotate_secret(kLocalTenant);
  REQUIRE(rotated);
  CHECK(*f.outbox().secrets(kLocalTenant) == std::vector{*rotated, first->front()});
  {
    auto database = Database::open(f.path());
    REQUIRE(database);
    REQUIRE(database->execute("UPDATE webhook_secret SET until = until - 86400000"));
  }
  CHECK(*f.outbox().secrets(kLocalTenant) == std::vector{*rotated});
  CHECK(refusal(f.outbox().secrets("nobody")) == ErrorCode::not_found);
  CHECK(refusal(f.outbox().rotate_secret("nobody")) == ErrorCode::not_found);
}
