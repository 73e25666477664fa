// The server or a worker dies: after a promise, while it works, at every named point.
#include <csignal>
#include <thread>

#include <fmt/format.h>

#include "server/os/kill_point.h"
#include "tests/chaos/arena.h"
#include "tests/chaos/scenarios.h"
#include "tests/service/support/job_follower.h"

namespace fairway::chaos {
namespace {

constexpr double kRequeueBound = 2000.0;
/// A kill that came after the end of its job is tried again.
constexpr int kTries = 10;

/// Sleeps for a random part of the time that the work takes.
void sleep_into(Trials& trials, const Work& work) {
  const auto microseconds = static_cast<std::size_t>(work.milliseconds * 900.0);
  std::this_thread::sleep_for(std::chrono::microseconds(trials.random(0, microseconds)));
}

/// True: the server was killed while the job ran.
bool kill_while_running(Trials& trials, Arena& arena, const Work& work, const std::string& id) {
  arena.wait_until_claimed(id);
  sleep_into(trials, work);
  const bool running = arena.job(id)["state"] == "running";
  arena.kill();
  return running;
}

/// The job runs again soon after the start, and ends as if nothing had been.
void expect_uncounted_death(Trials& trials, Arena& arena, const std::string& id) {
  trials.measure("killed server until its job runs", arena.until_running_again(id), "ms",
                 kRequeueBound);
  arena.expect_promises_kept();
  expect(arena.job(id)["attempt"] == 1, "the death of the server was counted as an attempt");
}

/// True: a worker was killed, and not too late to matter.
bool kill_running_worker(Trials& trials, Arena& arena, const Work& work) {
  const std::string id = arena.submit(work);
  arena.wait_until_claimed(id);
  sleep_into(trials, work);
  const auto workers = arena.service().workers();
  if (workers.empty() || ::kill(workers.front(), SIGKILL) != 0) return false;
  const auto began = std::chrono::steady_clock::now();
  const Json again = test::follow(arena.client(), path_of(id), [](const Json& job) {
    return (job["state"] != "queued" && job["state"] != "running") ||
           (job["attempt"] == 2 && job["state"] == "running");
  });
  if (again["attempt"] != 2) return false;
  trials.measure("killed worker until its job runs again", milliseconds_since(began), "ms",
                 kRequeueBound);
  return true;
}

/// Posts the work to a service that may die of it, and notes what it then owes.
void offer(Arena& arena, const Work& work) {
  const test::Answer answer = arena.client().post(
      "/v1/jobs?params=" + test::percent_encoded(work.parameters), work.mesh, "model/gltf-binary");
  expect(answer.status == 202 || answer.status == 0,
         fmt::format("the upload was answered {}", answer.status));
  if (answer.status == 202) arena.promise(answer.json()["id"], work.sha256);
}

/// A job that was stored, though its client never heard of it, is done like any other.
void adopt_unanswered(Arena& arena, const Work& work) {
  const Json jobs = arena.client().get("/v1/jobs").json()["jobs"];
  expect(jobs.size() <= 1, fmt::format("one upload became {} jobs", jobs.size()));
  if (!jobs.empty()) arena.promise(jobs[0]["id"], work.sha256);
}

void kill_service_at(Trials& trials, const std::string& place, const Work& work) {
  Arena arena(trials);
  arena.start({fmt::format("{}={}", kKillVariable, place)});
  offer(arena, work);
  expect(arena.wait_for_death(), "the service never passed this point");
  arena.kill();
  arena.start();
  adopt_unanswered(arena, work);
  arena.expect_promises_kept();
}

void kill_worker_at(Trials& trials, const std::string& place, const Work& work) {
  Arena arena(trials);
  arena.start({fmt::format("{}={}", kKillVariable, place)});
  const std::string id = arena.submit(work);
  arena.expect_promises_kept();
  expect(arena.job(id)["attempt"] == 2, "the worker never passed this point");
}

}  // namespace

void kill_after_accepting(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, {}, count, [&](Arena& arena, std::size_t) {
    const std::string id = arena.submit(workshop.small());
    arena.kill();
    arena.start();
    expect_uncounted_death(trials, arena, id);
    arena.expect_no_strangers();
  });
}

void kill_during_job(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, {}, count, [&](Arena& arena, std::size_t) {
    bool hit = false;
    for (int k = 0; k < kTries && !hit; ++k) {
      const Work work = workshop.busy();
      const std::string id = arena.submit(work);
      hit = kill_while_running(trials, arena, work, id);
      arena.start();
      expect_uncounted_death(trials, arena, id);
    }
    expect(hit, "no job was running when its server was killed");
  });
}

void kill_worker(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, {}, count, [&](Arena& arena, std::size_t) {
    bool hit = false;
    for (int k = 0; k < kTries && !hit; ++k) {
      hit = kill_running_worker(trials, arena, workshop.busy());
      arena.expect_promises_kept();
    }
    expect(hit, "no worker was killed while it worked");
  });
}

std::size_t kill_point_trials() {
  std::size_t passes = 0;
  for (const KillPoint& point : kKillPoints) passes += static_cast<std::size_t>(point.passes);
  return passes;
}

void kill_at_points(Trials& trials, Workshop& workshop, std::size_t) {
  for (const KillPoint& point : kKillPoints) {
    for (int pass = 1; pass <= point.passes; ++pass) {
      const std::string place = fmt::format("{}:{}", point.name, pass);
      const auto kill = point.passer == Passer::worker ? kill_worker_at : kill_service_at;
      trials.run(place, [&] { kill(trials, place, workshop.small()); });
    }
  }
}

}  // namespace fairway::chaos
