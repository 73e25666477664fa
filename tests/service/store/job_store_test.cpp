// The contract of JobStore: a job's life. Every implementation is put through the same cases.
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/job_store_fixture.h"

using namespace fairway;
using namespace fairway::test;
using namespace std::chrono_literals;

TEST_CASE("a submitted job is found with all that was given") {
  JobStoreFixture f;
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
  JobStoreFixture f;
  CHECK(refusal(f.store().find(JobName{.id = random_id()})) == ErrorCode::not_found);
  CHECK(refusal(f.store().cancel({.id = random_id()})) == ErrorCode::not_found);
}

TEST_CASE("a full queue refuses and keeps nothing") {
  JobStoreFixture f;
  f.submit();
  const std::string id = random_id();
  const NewJob late = new_job(id);
  CHECK(refusal(f.store().submit(late, {1})) == ErrorCode::queue_full);
  CHECK(refusal(f.store().find(JobName{.id = id})) == ErrorCode::not_found);
  CHECK(f.store().submit(late, {2}));
}

TEST_CASE("an id is taken once") {
  JobStoreFixture f;
  const std::string id = f.submit();
  NewJob again = new_job(id);
  again.fingerprint = "another print";
  CHECK(refusal(f.store().submit(again, {kRoom})) == ErrorCode::conflict);
}

TEST_CASE("jobs are claimed in the order they came, each once") {
  JobStoreFixture f;
  const std::string first = f.submit();
  const std::string second = f.submit();
  CHECK(f.claim().job.id == first);
  CHECK(f.claim().job.id == second);
  const auto nothing = f.store().claim("host", 60s);
  REQUIRE(nothing);
  CHECK_FALSE(*nothing);
}

TEST_CASE("a finished job has its result, its report and a new revision") {
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
  const std::string id = f.submit();
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  const auto canceled = f.store().cancel({.id = id});
  REQUIRE(canceled);
  CHECK(canceled->state == JobState::succeeded);
  CHECK(f.find(id).state == JobState::succeeded);
}

TEST_CASE("a cancel beats a later end of the work, whichever it is") {
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
  const std::string id = f.submit();
  f.claim();
  CHECK(*f.store().requeue_lost("another host") == 0);
  CHECK(f.find(id).state == JobState::running);
}

TEST_CASE("a lease that runs out returns the job to the queue; a heartbeat keeps it") {
  JobStoreFixture f;
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
  JobStoreFixture f;
  const std::string first = f.submit();
  f.submit();
  REQUIRE(f.store().give_back(f.claim().lease));
  CHECK(f.claim().job.id == first);
}

TEST_CASE("only a final job expires, and then has no result") {
  JobStoreFixture f;
  const std::string id = f.submit();
  CHECK(refusal(f.store().expire({.id = id})) == ErrorCode::conflict);
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  REQUIRE(f.store().expire({.id = id}));
  REQUIRE(f.store().expire({.id = id}));
  CHECK(f.find(id).state == JobState::expired);
  CHECK_FALSE(f.find(id).result);
}

TEST_CASE("needed blobs are the inputs and results of all jobs that are not expired") {
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
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
  JobStoreFixture f;
  const std::string id = random_id();
  NewJob scene = new_job(id);
  scene.input_files = 3;
  f.submit(scene);
  f.reopen();
  CHECK(f.find(id).input_files == 3);
  CHECK(f.claim().job.input_files == 3);
}

TEST_CASE("the trace of a submit is kept with the job, also over a restart") {
  JobStoreFixture f;
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
  JobStoreFixture f;
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

TEST_CASE("failed and canceled jobs are done again, with all their attempts") {
  JobStoreFixture f;
  const std::string id = f.submit();
  CHECK(refusal(f.store().retry({.id = id}, kRoom)) == ErrorCode::conflict);
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  REQUIRE(f.store().worker_died(f.claim().lease, kCrash));
  CHECK(refusal(f.store().retry({.id = id}, 0)) == ErrorCode::queue_full);
  REQUIRE(f.store().retry({.id = id}, kRoom));
  CHECK(f.find(id).state == JobState::queued);
  CHECK(f.find(id).attempt == 1);
  CHECK_FALSE(f.find(id).problem);
  CHECK_FALSE(f.find(id).expires);
  REQUIRE(f.store().cancel({.id = id}));
  REQUIRE(f.store().retry({.id = id}, kRoom));
  REQUIRE(f.store().finish(f.claim().lease, success_of(id)));
  CHECK(refusal(f.store().retry({.id = id}, kRoom)) == ErrorCode::conflict);
}

TEST_CASE("a final job is due when its time is over, and is forgotten long after") {
  JobStoreFixture f;
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
