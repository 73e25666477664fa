// The contract of JobStore. Every implementation is put through the same cases.
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/sqlite_job_store.h"
#include "server/os/random_id.h"
#include "tests/service/temporary_directory.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kRoom = 100;
const Error kCrash{ErrorCode::worker_crashed, "The worker ended."};

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

  std::string submit() {
    std::string id = random_id();
    const auto job = store().submit({id, {"in-" + id, 10, "aa"}, Format::glb, "{}"}, kRoom);
    REQUIRE(job);
    CHECK(job->state == JobState::queued);
    return id;
  }
  Claim claim(std::chrono::milliseconds lease = 60s) {
    auto claimed = store().claim("host", lease);
    REQUIRE(claimed);
    REQUIRE(*claimed);
    return **claimed;
  }
  Job find(const std::string& id) {
    auto job = store().find(id);
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
  CHECK(refusal(f.store().find(random_id())) == ErrorCode::not_found);
  CHECK(refusal(f.store().cancel(random_id())) == ErrorCode::not_found);
}

TEST_CASE("a full queue refuses and keeps nothing") {
  Fixture f;
  f.submit();
  const std::string id = random_id();
  const NewJob late{id, {"in", 1, "aa"}, Format::glb, "{}"};
  CHECK(refusal(f.store().submit(late, 1)) == ErrorCode::queue_full);
  CHECK(refusal(f.store().find(id)) == ErrorCode::not_found);
  CHECK(f.store().submit(late, 2));
}

TEST_CASE("an id is taken once") {
  Fixture f;
  const std::string id = f.submit();
  const NewJob again{id, {"in", 1, "aa"}, Format::glb, "{}"};
  CHECK(refusal(f.store().submit(again, kRoom)) == ErrorCode::conflict);
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
  const auto canceled = f.store().cancel(id);
  REQUIRE(canceled);
  CHECK(canceled->state == JobState::succeeded);
  CHECK(f.find(id).state == JobState::succeeded);
}

TEST_CASE("a cancel beats a later end of the work, whichever it is") {
  Fixture f;
  const std::string id = f.submit();
  const Claim claim = f.claim();
  REQUIRE(f.store().cancel(id));
  CHECK(refusal(f.store().heartbeat(claim.lease, 60s)) == ErrorCode::conflict);
  CHECK(refusal(f.store().finish(claim.lease, kCrash)) == ErrorCode::conflict);
  CHECK(refusal(f.store().finish(claim.lease, success_of(id))) == ErrorCode::conflict);
  CHECK(refusal(f.store().worker_died(claim.lease, kCrash)) == ErrorCode::conflict);
  CHECK(f.find(id).state == JobState::canceled);
}

TEST_CASE("canceling is idempotent and takes a queued job out of the queue") {
  Fixture f;
  const std::string id = f.submit();
  const auto first = f.store().cancel(id);
  const auto second = f.store().cancel(id);
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
  CHECK(refusal(f.store().expire(id)) == ErrorCode::conflict);
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  REQUIRE(f.store().expire(id));
  REQUIRE(f.store().expire(id));
  CHECK(f.find(id).state == JobState::expired);
  CHECK_FALSE(f.find(id).result);
}

TEST_CASE("needed blobs are the inputs of open jobs and the results that are kept") {
  Fixture f;
  const std::string done = f.submit();
  REQUIRE(f.store().finish(f.claim().lease, success_of(done)));
  const std::string open = f.submit();
  REQUIRE(f.store().cancel(f.submit()));
  CHECK(*f.store().needed_blobs() == std::vector<std::string>{"in-" + open, "out-" + done});
}

TEST_CASE("the list shows the newest first, by state, within its limit") {
  Fixture f;
  const std::string first = f.submit();
  const std::string second = f.submit();
  const std::string third = f.submit();
  REQUIRE(f.store().cancel(second));
  const auto two = f.store().list({{}, 2});
  REQUIRE(two);
  REQUIRE(two->size() == 2);
  CHECK(two->at(0).id == third);
  CHECK(two->at(1).id == second);
  const auto queued = f.store().list({JobState::queued, 10});
  REQUIRE(queued);
  REQUIRE(queued->size() == 2);
  CHECK(queued->at(1).id == first);
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
  REQUIRE(f.store().submit({id, {"in", 1, "aa"}, Format::gltf, "{}", 3}, kRoom));
  f.reopen();
  CHECK(f.find(id).input_files == 3);
  CHECK(f.claim().job.input_files == 3);
}

TEST_CASE("the trace of a submit is kept with the job, also over a restart") {
  Fixture f;
  const std::string trace(32, 'a');
  NewJob job{random_id(), {"in", 10, "aa"}, Format::glb, "{}"};
  job.trace_id = trace;
  REQUIRE(f.store().submit(job, kRoom)->trace_id == trace);
  f.reopen();
  CHECK(f.find(job.id).trace_id == trace);
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
  CHECK(f.store().cancel(second));
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

TEST_CASE("jobs of a fairwayd that knew one file per job are still done") {
  test::TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  const std::string id = random_id();
  {
    auto store = SqliteJobStore::open(path);
    REQUIRE(store);
    REQUIRE((*store)->submit({id, {"in", 1, "aa"}, Format::glb, "{}"}, kRoom));
    auto database = Database::open(path);
    REQUIRE(database);
    REQUIRE(database->execute("ALTER TABLE job DROP COLUMN input_files"));
    REQUIRE(database->execute("ALTER TABLE job DROP COLUMN trace_id; DROP TABLE probe"));
    REQUIRE(database->execute("PRAGMA user_version = 1"));
  }
  auto store = SqliteJobStore::open(path);
  REQUIRE(store);
  const auto claimed = (*store)->claim("host", 60s);
  REQUIRE(claimed);
  REQUIRE(*claimed);
  CHECK((*claimed)->job.id == id);
  CHECK((*claimed)->job.input_files == 1);
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
  REQUIRE((*store)->submit({id, {"in", 1, "aa"}, Format::glb, "{}"}, kRoom));
  auto database = Database::open(path);
  REQUIRE(database);
  CHECK(refusal(database->execute("UPDATE job SET state = 'done'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'running'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'succeeded', finished = 1")) ==
        ErrorCode::conflict);
}
