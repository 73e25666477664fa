// The contract of JobStore. Every implementation is put through the same cases.
#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/fairwayd/sqlite.h"
#include "server/fairwayd/sqlite_job_store.h"
#include "server/os/random_id.h"
#include "tests/service/temporary_directory.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kRoom = 100;
const Error kCrash{ErrorCode::worker_crashed, "The worker ended."};

NewJob new_job(const std::string& id) {
  NewJob job;
  job.name.id = id;
  job.input = {"in-" + id, 10, "aa"};
  job.parameters = "{}";
  job.fingerprint = "print of " + id;
  return job;
}

/// A store that can be closed and opened again, as a restart of the server does.
class Fixture {
 public:
  Fixture() { reopen(); }

  void reopen() {
    store_.reset();
    auto opened = SqliteJobStore::open(path());
    REQUIRE(opened);
    store_ = std::move(*opened);
  }
  std::filesystem::path path() const { return directory_.path() / "jobs.sqlite"; }
  JobStore& store() { return *store_; }

  std::string submit() { return submit(new_job(random_id())); }
  std::string submit(const NewJob& job) {
    const auto submitted = store().submit(job, {kRoom});
    REQUIRE(submitted);
    CHECK(submitted->is_new);
    CHECK(submitted->job.state == JobState::queued);
    return job.name.id;
  }
  Claim claim(std::chrono::milliseconds lease = 60s) {
    auto claimed = store().claim("host", lease);
    REQUIRE(claimed);
    REQUIRE(*claimed);
    return **claimed;
  }
  Job find(const std::string& id) {
    auto job = store().find(JobName{.id = id});
    REQUIRE(job);
    return *job;
  }

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<JobStore> store_;
};

Success success_of(const std::string& id) {
  return {{"out-" + id, 20, "bb"}, Format::drc, R"({"steps":3})"};
}

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

}  // namespace

TEST_CASE("a submitted job is found with all that was given") {
  Fixture f;
  const std::string id = f.submit();
  const Job job = f.find(id);
  CHECK(job.input.key == "in-" + id);
  CHECK(job.input.bytes == 10);
  CHECK(job.input.sha256 == "aa");
  CHECK(job.parameters == "{}");
  CHECK(job.attempt == 1);
  CHECK(job.revision == 1);
  CHECK(job.created > 0);
  CHECK_FALSE(job.started);
}

TEST_CASE("an unknown job is not found") {
  Fixture f;
  CHECK(refusal(f.store().find(JobName{.id = random_id()})) == ErrorCode::not_found);
  CHECK(refusal(f.store().cancel({.id = random_id()})) == ErrorCode::not_found);
}

TEST_CASE("a full queue refuses and keeps nothing") {
  Fixture f;
  f.submit();
  const std::string id = random_id();
  const NewJob late = new_job(id);
  CHECK(refusal(f.store().submit(late, {1})) == ErrorCode::queue_full);
  CHECK(refusal(f.store().find(JobName{.id = id})) == ErrorCode::not_found);
  CHECK(f.store().submit(late, {2}));
}

TEST_CASE("the length of the queue is told while a submission waits for the disk") {
  Fixture f;
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

TEST_CASE("an id is taken once") {
  Fixture f;
  const std::string id = f.submit();
  NewJob again = new_job(id);
  again.fingerprint = "another print";
  CHECK(refusal(f.store().submit(again, {kRoom})) == ErrorCode::conflict);
}

TEST_CASE("jobs are claimed in the order they came, each once") {
  Fixture f;
  const std::string first = f.submit();
  const std::string second = f.submit();
  CHECK(f.claim().job.id == first);
  CHECK(f.claim().job.id == second);
  const auto nothing = f.store().claim("host", 60s);
  REQUIRE(nothing);
  CHECK_FALSE(*nothing);
}

TEST_CASE("a finished job has its result, its report and a new revision") {
  Fixture f;
  const std::string id = f.submit();
  const Claim claim = f.claim();
  REQUIRE(f.store().finish(claim.lease, success_of(id)));
  f.reopen();
  const Job job = f.find(id);
  CHECK(job.state == JobState::succeeded);
  REQUIRE(job.result);
  CHECK(job.result->key == "out-" + id);
  CHECK(job.result->bytes == 20);
  CHECK(job.result_format == Format::drc);
  CHECK(job.report == R"({"steps":3})");
  CHECK(job.revision == 3);
  CHECK(job.finished >= job.started);
}

TEST_CASE("a failed job keeps its problem") {
  Fixture f;
  const std::string id = f.submit();
  REQUIRE(f.store().finish(f.claim().lease,
                           Error{ErrorCode::invalid_mesh, "An index is too large.", "/meshes/0"}));
  const Job job = f.find(id);
  CHECK(job.state == JobState::failed);
  REQUIRE(job.problem);
  CHECK(job.problem->code == ErrorCode::invalid_mesh);
  CHECK(job.problem->message == "An index is too large.");
  CHECK(job.problem->pointer == "/meshes/0");
}

TEST_CASE("a late attempt with an old fencing token changes nothing") {
  Fixture f;
  const std::string id = f.submit();
  const Claim old = f.claim();
  REQUIRE(f.store().give_back(old.lease));
  const Claim current = f.claim();
  CHECK(current.lease.fence > old.lease.fence);

  const std::int64_t revision = f.find(id).revision;
  CHECK(refusal(f.store().finish(old.lease, success_of("old"))) == ErrorCode::conflict);
  CHECK(refusal(f.store().heartbeat(old.lease, 60s)) == ErrorCode::conflict);
  CHECK(refusal(f.store().give_back(old.lease)) == ErrorCode::conflict);
  CHECK(refusal(f.store().worker_died(old.lease, kCrash)) == ErrorCode::conflict);
  CHECK(f.find(id).revision == revision);
  CHECK(f.find(id).state == JobState::running);

  REQUIRE(f.store().finish(current.lease, success_of(id)));
  CHECK(refusal(f.store().finish(current.lease, success_of("twice"))) == ErrorCode::conflict);
  CHECK(f.find(id).result->key == "out-" + id);
}

TEST_CASE("a committed result beats a cancel") {
  Fixture f;
  const std::string id = f.submit();
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  const auto canceled = f.store().cancel({.id = id});
  REQUIRE(canceled);
  CHECK(canceled->state == JobState::succeeded);
  CHECK(f.find(id).state == JobState::succeeded);
}

TEST_CASE("a cancel beats a later end of the work, whichever it is") {
  Fixture f;
  const std::string id = f.submit();
  const Claim claim = f.claim();
  REQUIRE(f.store().cancel({.id = id}));
  CHECK(refusal(f.store().heartbeat(claim.lease, 60s)) == ErrorCode::conflict);
  CHECK(refusal(f.store().finish(claim.lease, kCrash)) == ErrorCode::conflict);
  CHECK(refusal(f.store().finish(claim.lease, success_of(id))) == ErrorCode::conflict);
  CHECK(refusal(f.store().worker_died(claim.lease, kCrash)) == ErrorCode::conflict);
  CHECK(f.find(id).state == JobState::canceled);
}

TEST_CASE("canceling is idempotent and takes a queued job out of the queue") {
  Fixture f;
  const std::string id = f.submit();
  const auto first = f.store().cancel({.id = id});
  const auto second = f.store().cancel({.id = id});
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first->revision == second->revision);
  CHECK(*f.store().queue_length() == 0);
  CHECK_FALSE(*f.store().claim("host", 60s));
}

TEST_CASE("one death of a worker is retried, the second fails the job") {
  Fixture f;
  const std::string id = f.submit();
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  CHECK(f.find(id).state == JobState::queued);
  CHECK(f.find(id).attempt == 2);
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  const Job job = f.find(id);
  CHECK(job.state == JobState::failed);
  CHECK(job.attempt == 2);
  REQUIRE(job.problem);
  CHECK(job.problem->code == ErrorCode::worker_crashed);
}

TEST_CASE("leases lost with the server are not counted, however often") {
  Fixture f;
  const std::string id = f.submit();
  for (int restart = 0; restart < 5; ++restart) {
    f.claim();
    f.reopen();
    CHECK(f.find(id).state == JobState::running);
    CHECK(*f.store().requeue_lost("host") == 1);
    CHECK(f.find(id).state == JobState::queued);
    CHECK(f.find(id).attempt == 1);
  }
}

TEST_CASE("a starting host takes back its own leases only") {
  Fixture f;
  const std::string id = f.submit();
  f.claim();
  CHECK(*f.store().requeue_lost("another host") == 0);
  CHECK(f.find(id).state == JobState::running);
}

TEST_CASE("a lease that runs out returns the job to the queue; a heartbeat keeps it") {
  Fixture f;
  const std::string id = f.submit();
  const Claim lost = f.claim(20ms);
  REQUIRE(f.store().heartbeat(lost.lease, 60s));
  std::this_thread::sleep_for(40ms);
  CHECK_FALSE(*f.store().claim("host", 60s));
  REQUIRE(f.store().heartbeat(lost.lease, 1ms));
  std::this_thread::sleep_for(20ms);
  const Claim again = f.claim();
  CHECK(again.job.id == id);
  CHECK(again.job.attempt == 1);
  CHECK(refusal(f.store().finish(lost.lease, success_of(id))) == ErrorCode::conflict);
}

TEST_CASE("a requeued job keeps its place in the queue") {
  Fixture f;
  const std::string first = f.submit();
  f.submit();
  REQUIRE(f.store().give_back(f.claim().lease));
  CHECK(f.claim().job.id == first);
}

TEST_CASE("only a final job expires, and then has no result") {
  Fixture f;
  const std::string id = f.submit();
  CHECK(refusal(f.store().expire({.id = id})) == ErrorCode::conflict);
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  REQUIRE(f.store().expire({.id = id}));
  REQUIRE(f.store().expire({.id = id}));
  CHECK(f.find(id).state == JobState::expired);
  CHECK_FALSE(f.find(id).result);
}

TEST_CASE("needed blobs are the inputs and results of all jobs that are not expired") {
  Fixture f;
  const std::string done = f.submit();
  REQUIRE(f.store().finish(f.claim().lease, success_of(done)));
  const std::string open = f.submit();
  const std::string canceled = f.submit();
  REQUIRE(f.store().cancel({.id = canceled}));
  const std::string gone = f.submit();
  REQUIRE(f.store().cancel({.id = gone}));
  REQUIRE(f.store().expire({.id = gone}));
  const auto needed = f.store().needed_blobs();
  REQUIRE(needed);
  CHECK(std::set<std::string>(needed->begin(), needed->end()) ==
        std::set<std::string>{"in-" + done, "out-" + done, "in-" + open, "in-" + canceled});
}

TEST_CASE("the list shows the newest first, by state, within its limit") {
  Fixture f;
  const std::string first = f.submit();
  const std::string second = f.submit();
  const std::string third = f.submit();
  REQUIRE(f.store().cancel({.id = second}));
  const auto two = f.store().list({.limit = 2});
  REQUIRE(two);
  REQUIRE(two->jobs.size() == 2);
  CHECK(two->has_more);
  CHECK(two->jobs[0].id == third);
  CHECK(two->jobs[1].id == second);
  const auto rest = f.store().list({.before = two->jobs[1].number});
  REQUIRE(rest);
  REQUIRE(rest->jobs.size() == 1);
  CHECK(rest->jobs[0].id == first);
  CHECK_FALSE(rest->has_more);
  const auto queued = f.store().list({.state = JobState::queued, .limit = 10});
  REQUIRE(queued);
  REQUIRE(queued->jobs.size() == 2);
  CHECK(queued->jobs[1].id == first);
}

TEST_CASE("many threads claim every job exactly once") {
  Fixture f;
  constexpr int kJobs = 40;
  for (int i = 0; i < kJobs; ++i) f.submit();
  std::atomic<int> claimed = 0;
  {
    std::vector<std::jthread> threads;
    threads.reserve(4);
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        while (true) {
          const auto claim = f.store().claim("host", 60s);
          if (!claim || !*claim) return;
          if (f.store().finish((*claim)->lease, success_of((*claim)->job.id))) ++claimed;
        }
      });
    }
  }
  CHECK(claimed == kJobs);
}

TEST_CASE("how many files an input has is kept") {
  Fixture f;
  const std::string id = random_id();
  NewJob scene = new_job(id);
  scene.input_files = 3;
  f.submit(scene);
  f.reopen();
  CHECK(f.find(id).input_files == 3);
  CHECK(f.claim().job.input_files == 3);
}

TEST_CASE("the trace of a submit is kept with the job, also over a restart") {
  Fixture f;
  const std::string trace(32, 'a');
  NewJob job = new_job(random_id());
  job.trace_id = trace;
  REQUIRE(f.store().submit(job, {kRoom})->job.trace_id == trace);
  f.reopen();
  CHECK(f.find(job.name.id).trace_id == trace);
  CHECK(f.claim().job.trace_id == trace);
  CHECK(f.find(f.submit()).trace_id.empty());
}

TEST_CASE("jobs are counted by state, and the oldest that waits is known") {
  Fixture f;
  const auto counts = [&] {
    const auto counted = f.store().counts();
    REQUIRE(counted);
    return *counted;
  };
  CHECK(counts().by_state.size() == 6);
  CHECK(counts().by_state.at(JobState::queued) == 0);
  CHECK_FALSE(counts().oldest_queued);
  const std::string first = f.submit();
  const std::string second = f.submit();
  f.submit();
  CHECK(counts().by_state.at(JobState::queued) == 3);
  CHECK(counts().oldest_queued == f.find(first).created);
  f.claim();
  CHECK(f.store().cancel({.id = second}));
  CHECK(counts().by_state.at(JobState::running) == 1);
  CHECK(counts().by_state.at(JobState::canceled) == 1);
  CHECK(counts().by_state.at(JobState::queued) == 1);
}

TEST_CASE("a probe writes, as often as it is asked to, and fails where nothing can be written") {
  Fixture f;
  CHECK(f.store().probe());
  CHECK(f.store().probe());
  auto other = Database::open(f.path());
  REQUIRE(other);
  const auto lock = Transaction::begin(*other);
  REQUIRE(lock);
  CHECK(refusal(f.store().probe()) == ErrorCode::unavailable);
}

TEST_CASE("jobs of the first fairwayd are still done, and its results are still there") {
  test::TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  const std::string queued = random_id();
  const std::string done = random_id();
  {
    auto database = Database::open(path);
    REQUIRE(database);
    // Its columns and what it kept in them; its checks are no matter here.
    REQUIRE(database->execute(R"(
      CREATE TABLE job (seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE,
        state TEXT NOT NULL, revision INTEGER NOT NULL, attempt INTEGER NOT NULL,
        fence INTEGER NOT NULL, lease_owner TEXT, lease_until INTEGER, created INTEGER NOT NULL,
        started INTEGER, finished INTEGER, input_key TEXT NOT NULL, input_bytes INTEGER NOT NULL,
        input_sha256 TEXT NOT NULL, input_format TEXT NOT NULL, parameters TEXT NOT NULL,
        problem TEXT, report TEXT, result_key TEXT, result_bytes INTEGER, result_sha256 TEXT,
        result_format TEXT) STRICT;
      CREATE INDEX job_by_state ON job (state, seq);
      PRAGMA user_version = 1;)"));
    REQUIRE(
        database->execute("INSERT INTO job (id, state, revision, attempt, fence, created, "
                          "input_key, input_bytes, input_sha256, input_format, parameters) "
                          "VALUES ('" +
                          queued +
                          "', 'queued', 1, 1, 0, 5, 'in', 7, 'aa', "
                          "'glb', '{}')"));
    REQUIRE(database->execute(
        "INSERT INTO job (id, state, revision, attempt, fence, created, started, finished, "
        "input_key, input_bytes, input_sha256, input_format, parameters, report, result_key, "
        "result_bytes, result_sha256, result_format) VALUES ('" +
        done +
        "', 'succeeded', 3, 1, 1, "
        "5, 6, 8, 'in2', 7, 'aa', 'glb', '{}', '{}', 'out', 9, 'bb', 'ply')"));
  }
  auto store = SqliteJobStore::open(path);
  REQUIRE(store);
  const auto claimed = (*store)->claim("host", 60s);
  REQUIRE(claimed);
  REQUIRE(*claimed);
  CHECK((*claimed)->job.id == queued);
  CHECK((*claimed)->job.input.bytes == 7);
  CHECK((*claimed)->job.input_files == 1);
  const auto old = (*store)->find(JobName{.id = done});
  REQUIRE(old);
  REQUIRE(old->result);
  CHECK(old->result->key == "out");
  CHECK(old->result_format == Format::ply);
  CHECK(old->expires == 8 + 86'400'000);
}

TEST_CASE("a tenant's jobs are another tenant's secret") {
  Fixture f;
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
  Fixture f;
  const auto submit = [&](const std::string& tenant, const std::string& id) {
    NewJob job = new_job(id);
    job.name.tenant = tenant;
    f.submit(job);
  };
  for (int i = 0; i < 4; ++i) submit("busy", fmt::format("b{}", i));
  for (int i = 0; i < 2; ++i) submit("late", fmt::format("l{}", i));
  std::vector<std::string> order;
  for (int i = 0; i < 6; ++i) order.push_back(f.claim().job.id);
  CHECK(order == std::vector<std::string>{"b0", "l0", "b1", "l1", "b2", "b3"});
}

TEST_CASE("who was away has no turns saved up") {
  Fixture f;
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
  Fixture f;
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
  for (int i = 0; i < 4; ++i) order.push_back(f.claim().job.id);
  CHECK(order == std::vector<std::string>{"first", "second", "usual", "low"});
}

TEST_CASE("one key is one job; with another request it is refused") {
  Fixture f;
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
  Fixture fixture;
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
  Fixture f;
  const NewJob job = new_job("mine");
  f.submit(job);
  const auto same = f.store().submit(job, {kRoom});
  REQUIRE(same);
  CHECK_FALSE(same->is_new);
}

TEST_CASE("equal content shares the result, and the blobs live as long as either job") {
  Fixture f;
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

TEST_CASE("failed and canceled jobs are done again, with all their attempts") {
  Fixture f;
  const std::string id = f.submit();
  CHECK(refusal(f.store().retry({.id = id}, {kRoom})) == ErrorCode::conflict);
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  CHECK(refusal(f.store().retry({.id = id}, 0)) == ErrorCode::queue_full);
  REQUIRE(f.store().retry({.id = id}, {kRoom}));
  CHECK(f.find(id).state == JobState::queued);
  CHECK(f.find(id).attempt == 1);
  CHECK_FALSE(f.find(id).problem);
  CHECK_FALSE(f.find(id).expires);
  REQUIRE(f.store().cancel({.id = id}));
  REQUIRE(f.store().retry({.id = id}, {kRoom}));
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  CHECK(refusal(f.store().retry({.id = id}, {kRoom})) == ErrorCode::conflict);
}

TEST_CASE("a final job is due when its time is over, and is forgotten long after") {
  Fixture f;
  NewJob job = new_job("short");
  job.keep = 1000ms;
  f.submit(job);
  f.submit(new_job("long"));
  REQUIRE(f.store().finish(f.claim().lease, success_of("short")));
  REQUIRE(f.store().cancel({.id = "long"}));
  const UnixMillis end = *f.find("short").finished;
  CHECK(f.find("short").expires == end + 1000);
  CHECK(f.store().due(end + 999, 10)->empty());
  const auto due = f.store().due(end + 1000, 10);
  REQUIRE(due);
  REQUIRE(due->size() == 1);
  CHECK(due->front().id == "short");
  CHECK(f.store().due(end + 86'500'000, 1)->size() == 1);
  REQUIRE(f.store().expire({.id = "short"}));
  CHECK(*f.store().forget(end) == 0);
  CHECK(*f.store().forget(end + 1) == 1);
  CHECK(refusal(f.store().find(JobName{.id = "short"})) == ErrorCode::not_found);
}

TEST_CASE("jobs are listed and counted by all the labels that are asked for") {
  Fixture f;
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

TEST_CASE("a database of a newer fairwayd is refused") {
  test::TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  {
    auto database = Database::open(path);
    REQUIRE(database);
    REQUIRE(database->execute("PRAGMA user_version = 99"));
  }
  CHECK(refusal(SqliteJobStore::open(path)) == ErrorCode::conflict);
}

TEST_CASE("the database itself refuses a state that cannot be") {
  test::TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  auto store = SqliteJobStore::open(path);
  REQUIRE(store);
  const std::string id = random_id();
  REQUIRE((*store)->submit(new_job(id), {kRoom}));
  auto database = Database::open(path);
  REQUIRE(database);
  CHECK(refusal(database->execute("UPDATE job SET state = 'done'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'running'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'succeeded', finished = 1")) ==
        ErrorCode::conflict);
}
