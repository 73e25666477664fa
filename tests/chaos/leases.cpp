// A server or a worker stands still for longer than its lease, and goes on.
#include <array>
#include <csignal>
#include <future>
#include <thread>

#include <fmt/format.h>
#include <sys/wait.h>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/os/kill_point.h"
#include "tests/chaos/arena.h"
#include "tests/chaos/scenarios.h"
#include "tests/service/support/job_follower.h"

namespace fairway::chaos {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

const std::vector<std::string> kShortLease = {"--lease", "3", "--workers", "2"};
constexpr milliseconds kPastLease{3500};
/// Time for a server that goes on to do what it must not.
constexpr milliseconds kTemptation{1500};
constexpr milliseconds kPatience{30000};
/// Submitted, claimed, ended: what the revisions of an undisturbed job count.
constexpr int kUndisturbedRevision = 3;

/// Where a server may freeze with a lease in its hand.
constexpr std::array kFreezeAt = {"claim.committed", "worker.spawned", "worker.reaped",
                                  "result.adopted"};

void wait_until_frozen(pid_t pid) {
  const auto until = steady_clock::now() + kPatience;
  siginfo_t stopped{};
  while (stopped.si_pid == 0) {
    expect(steady_clock::now() < until, "the service never froze");
    ::waitid(P_PID, static_cast<id_t>(pid), &stopped, WSTOPPED | WNOHANG | WNOWAIT);
    std::this_thread::sleep_for(milliseconds(2));
  }
}

/// Another worker host of the same store takes the job as soon as its lease is over.
Claim take_over(JobStore& store) {
  const auto until = steady_clock::now() + kPatience;
  while (steady_clock::now() < until) {
    auto claim = store.claim("another host", std::chrono::minutes(5));
    if (!claim) throw Broken("the store of a frozen server: " + claim.error().message);
    if (*claim) return **std::move(claim);
    std::this_thread::sleep_for(milliseconds(20));
  }
  throw Broken("the lease of a frozen server never ended");
}

/// The late server changes nothing while the other one has the job.
void expect_no_late_result(const Arena& arena, const std::string& id, const Json& taken) {
  const auto until = steady_clock::now() + kTemptation;
  while (steady_clock::now() < until) {
    const Json job = arena.job(id);
    expect(job["state"] == "running" && job["revision"] == taken["revision"],
           "a late server changed the job: " + job.dump());
    std::this_thread::sleep_for(milliseconds(10));
  }
  expect(!arena.has_result(id), "the late result was kept");
}

void lose_lease_at(Trials& trials, const Work& work, const char* point) {
  Arena arena(trials, {"--lease", "3", "--workers", "1"});
  arena.start({fmt::format("{}={}", kStopVariable, point)});
  // The service may freeze before it answers.
  auto answer = std::async(std::launch::async, [&work, client = arena.client()] {
    return client.post("/v1/jobs?params=" + test::percent_encoded(work.parameters), work.mesh,
                       "model/gltf-binary");
  });
  wait_until_frozen(arena.service().pid());
  auto store = SqliteJobStore::open(arena.directory() / "jobs.sqlite");
  expect(static_cast<bool>(store), "the store of a frozen server cannot be opened");
  const Claim claim = take_over(**store);
  arena.service().signal(SIGCONT);
  expect(answer.get().status == 202, "the upload was not accepted");
  const std::string id = arena.client().get("/v1/jobs").json()["jobs"][0]["id"];
  arena.promise(id, work.sha256);
  expect_no_late_result(arena, id, arena.job(id));
  expect(static_cast<bool>((*store)->give_back(claim.lease)), "the other host lost its lease");
  arena.expect_promises_kept();
  expect(arena.job(id)["attempt"] == 1, "a lost lease was counted as an attempt");
}

}  // namespace

void stop_worker(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, kShortLease, count, [&](Arena& arena, std::size_t) {
    const std::string id = arena.submit(workshop.busy());
    test::wait_until_busy(arena.client(), path_of(id));
    const auto workers = arena.service().workers();
    expect(workers.size() == 1, "the job has not one worker");
    ::kill(workers.front(), SIGSTOP);
    std::this_thread::sleep_for(kPastLease);
    const Json job = arena.job(id);
    ::kill(workers.front(), SIGCONT);
    expect(job["state"] == "running", "a living server lost its lease: " + job.dump());
    arena.expect_promises_kept();
    expect(arena.job(id)["revision"] == kUndisturbedRevision, "the job was begun twice");
  });
}

void stop_server(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, kShortLease, count, [&](Arena& arena, std::size_t) {
    const std::string id = arena.submit(workshop.busy());
    test::wait_until_busy(arena.client(), path_of(id));
    arena.service().signal(SIGSTOP);
    std::this_thread::sleep_for(kPastLease);
    arena.service().signal(SIGCONT);
    arena.expect_promises_kept();
    const Json job = arena.job(id);
    expect(job["attempt"] == 1, "a lost lease was counted as an attempt");
    // Whichever slot woke first: the old one with its result, or the other one with a new lease.
    trials.note("stopped server: revisions of its job", job["revision"].get<double>());
  });
}

void lose_lease(Trials& trials, Workshop& workshop, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const char* point = kFreezeAt.at(i % kFreezeAt.size());
    trials.run(point, [&] { lose_lease_at(trials, workshop.small(), point); });
  }
}

}  // namespace fairway::chaos
