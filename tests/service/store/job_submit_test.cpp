// The contract of JobStore: which jobs a submit makes, whose they are, and whose turn it is.
#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/fairwayd/store/sqlite.h"
#include "server/fairwayd/store/sqlite_tenant_store.h"
#include "tests/service/support/job_store_fixture.h"

using namespace fairway;
using namespace fairway::test;
using namespace std::chrono_literals;

TEST_CASE("the length of the queue is told while a submission waits for the disk") {
  JobStoreFixture f;
  f.submit();
  auto other = Database::open(f.path());
  REQUIRE(other);
  std::atomic<bool> submitted = false;
  std::jthread submission;
  {
    const auto writing = Transaction::begin(*other);
    REQUIRE(writing);
    submission = std::jthread(
        [&] { submitted = static_cast<bool>(f.store().submit(new_job(random_id()), {kRoom})); });
    // Time to begin to wait; where it is too short, the test passes.
    std::this_thread::sleep_for(200ms);
    const auto length = f.store().queue_length();
    REQUIRE(length);
    CHECK(*length == 1);
    CHECK_FALSE(submitted);
  }
  submission.join();
  CHECK(submitted);
}

TEST_CASE("a tenant's jobs are another tenant's secret") {
  JobStoreFixture f;
  NewJob mine = new_job("one");
  NewJob theirs = new_job("one");
  theirs.name.tenant = "other";
  f.submit(mine);
  f.submit(theirs);
  CHECK(f.find("one").tenant == kLocalTenant);
  CHECK(f.store().find(JobName{"other", "one"})->tenant == "other");
  CHECK(refusal(f.store().find(JobName{"third", "one"})) == ErrorCode::not_found);
  CHECK(f.store().list({.tenant = "other"})->jobs.size() == 1);
  CHECK(f.store().count({.tenant = "other"})->at(JobState::queued) == 1);
  CHECK(refusal(f.store().find_input("third", "aa")) == ErrorCode::not_found);
}

TEST_CASE("tenants take turns, whatever one of them has queued before") {
  JobStoreFixture f;
  const auto submit = [&](const std::string& tenant, const std::string& id) {
    NewJob job = new_job(id);
    job.name.tenant = tenant;
    f.submit(job);
  };
  for (int i = 0; i < 4; ++i) submit("busy", fmt::format("b{}", i));
  for (int i = 0; i < 2; ++i) submit("late", fmt::format("l{}", i));
  std::vector<std::string> order;
  order.reserve(6);
  for (int i = 0; i < 6; ++i) order.push_back(f.claim().job.id);
  CHECK(order == std::vector<std::string>{"b0", "l0", "b1", "l1", "b2", "b3"});
}

TEST_CASE("who was away has no turns saved up") {
  JobStoreFixture f;
  const auto submit = [&](const std::string& tenant, const std::string& id) {
    NewJob job = new_job(id);
    job.name.tenant = tenant;
    f.submit(job);
  };
  submit("away", "a0");
  REQUIRE(f.store().finish(f.claim().lease, kCrash));
  for (int i = 0; i < 6; ++i) submit("busy", fmt::format("b{}", i));
  for (int i = 0; i < 4; ++i) f.claim();
  for (int i = 1; i < 4; ++i) submit("away", fmt::format("a{}", i));
  const std::string first = f.claim().job.id;
  const std::string second = f.claim().job.id;
  CHECK(first.front() != second.front());
}

TEST_CASE("of one tenant the highest priority goes first, of that the oldest job") {
  JobStoreFixture f;
  const auto submit = [&](const std::string& id, int priority) {
    NewJob job = new_job(id);
    job.options.priority = priority;
    f.submit(job);
  };
  submit("low", -3);
  submit("first", 5);
  submit("second", 5);
  submit("usual", 0);
  CHECK(*f.store().jobs_before(f.find("low")) == 3);
  CHECK(*f.store().jobs_before(f.find("second")) == 1);
  std::vector<std::string> order;
  order.reserve(4);
  for (int i = 0; i < 4; ++i) order.push_back(f.claim().job.id);
  CHECK(order == std::vector<std::string>{"first", "second", "usual", "low"});
}

TEST_CASE("one key is one job; with another request it is refused") {
  JobStoreFixture f;
  NewJob job = new_job(random_id());
  job.idempotency_key = "key";
  f.submit(job);
  NewJob again = job;
  again.name.id = random_id();
  const auto same = f.store().submit(again, {kRoom});
  REQUIRE(same);
  CHECK_FALSE(same->is_new);
  CHECK(same->job.id == job.name.id);
  again.fingerprint = "other";
  CHECK(refusal(f.store().submit(again, {kRoom})) == ErrorCode::key_reused);
  again.name.tenant = "other";
  CHECK(f.store().submit(again, {kRoom})->is_new);
}

TEST_CASE("a submit that came before is known by its key or its id, to its tenant") {
  JobStoreFixture fixture;
  NewJob job = new_job("a");
  job.idempotency_key = "k";
  fixture.submit(job);
  fixture.submit(new_job("b"));
  const auto has = [&](const JobName& name, const std::string& key) {
    const auto found = fixture.store().has_submit(name, key);
    REQUIRE(found);
    return *found;
  };
  CHECK(has({.id = "a"}, ""));
  CHECK(has({.id = "new"}, "k"));
  CHECK_FALSE(has({.id = "new"}, ""));
  CHECK_FALSE(has({.id = "new"}, "other"));
  CHECK_FALSE(has({"stranger", "a"}, "k"));
}

TEST_CASE("an id of the client's own is one job") {
  JobStoreFixture f;
  const NewJob job = new_job("mine");
  f.submit(job);
  const auto same = f.store().submit(job, {kRoom});
  REQUIRE(same);
  CHECK_FALSE(same->is_new);
}

TEST_CASE("equal content shares the result, and the blobs live as long as either job") {
  JobStoreFixture f;
  NewJob first = new_job("first");
  first.content = "content";
  f.submit(first);
  NewJob second = new_job("second");
  second.content = "content";
  CHECK(f.store().submit(second, {kRoom})->job.state == JobState::queued);
  const Claim claim = f.claim();
  REQUIRE(claim.job.id == "first");
  REQUIRE(f.store().finish(claim.lease, success_of("first")));

  NewJob third = new_job("third");
  third.content = "content";
  const auto shared = f.store().submit(third, {0});
  REQUIRE(shared);
  CHECK(shared->job.state == JobState::succeeded);
  CHECK(shared->job.cached);
  CHECK(shared->job.result->key == "out-first");
  CHECK(shared->job.input.key == "in-first");
  CHECK(shared->job.report == R"({"steps":3})");

  NewJob anew = new_job("anew");
  anew.content = "content";
  anew.may_share = false;
  CHECK(f.store().submit(anew, {kRoom})->job.state == JobState::queued);
  NewJob elsewhere = new_job("elsewhere");
  elsewhere.content = "content";
  elsewhere.name.tenant = "other";
  CHECK(f.store().submit(elsewhere, {kRoom})->job.state == JobState::queued);

  CHECK(f.store().expire({.id = "first"})->blobs.empty());
  CHECK(f.store().expire({.id = "third"})->blobs ==
        std::vector<std::string>{"in-first", "out-first"});
}

TEST_CASE("jobs are listed and counted by all the labels that are asked for") {
  JobStoreFixture f;
  const auto submit = [&](const std::string& id, std::vector<std::string> labels) {
    NewJob job = new_job(id);
    job.options.labels = std::move(labels);
    f.submit(job);
  };
  submit("a", {"batch:1", "red"});
  submit("b", {"batch:1"});
  submit("c", {"batch:2", "red"});
  REQUIRE(f.store().cancel({.id = "a"}));
  const auto ids = [&](std::vector<std::string> labels) {
    std::vector<std::string> out;
    const auto page = f.store().list({.labels = std::move(labels)});
    REQUIRE(page);
    for (const Job& job : page->jobs) out.push_back(job.id);
    return out;
  };
  CHECK(ids({"batch:1"}) == std::vector<std::string>{"b", "a"});
  CHECK(ids({"batch:1", "red"}) == std::vector<std::string>{"a"});
  CHECK(ids({"blue"}).empty());
  CHECK(ids({}).size() == 3);
  const auto counts = f.store().count({.labels = {"batch:1"}});
  REQUIRE(counts);
  CHECK(counts->size() == 6);
  CHECK(counts->at(JobState::queued) == 1);
  CHECK(counts->at(JobState::canceled) == 1);
  CHECK(f.find("a").options.labels == std::vector<std::string>{"batch:1", "red"});
}

TEST_CASE("a tenant has only so many jobs running, and others go on") {
  JobStoreFixture f;
  const auto tenants = SqliteTenantStore::open(f.path());
  REQUIRE(tenants);
  REQUIRE((*tenants)->set_tenant({"narrow", 1, 1, {}, {}}));
  for (const char* id : {"a", "b"}) {
    NewJob job = new_job(id);
    job.name.tenant = "narrow";
    f.submit(job);
  }
  const Claim first = f.claim();
  CHECK(first.job.id == "a");
  const auto nothing = f.store().claim("host", 60s);
  REQUIRE(nothing);
  CHECK_FALSE(*nothing);
  f.submit(new_job("c"));
  CHECK(f.claim().job.id == "c");
  REQUIRE(f.store().finish(first.lease, success_of("a")));
  CHECK(f.claim().job.id == "b");
}
