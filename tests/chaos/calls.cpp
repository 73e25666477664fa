// The server dies at each system call between the end of a worker and that of its job.
#include <thread>

#include <fmt/format.h>

#include "tests/chaos/arena.h"
#include "tests/chaos/scenarios.h"

namespace fairway::chaos {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kMostCalls = 200;
constexpr std::chrono::seconds kPatience{30};
/// After the last call that belongs to the job.
constexpr milliseconds kRest{200};

/// The job is over in all respects.
bool is_settled(const Arena& arena, const std::string& id) {
  const test::Answer answer = arena.client().get(path_of(id));
  if (answer.status != 200) return false;
  const bool has_input = std::filesystem::exists(arena.directory() / "blobs" / ("in-" + id));
  return answer.json()["state"] == "succeeded" && !has_input;
}

/// False: the job was settled without so many calls.
bool dies(const Arena& arena, const std::string& id) {
  const auto until = steady_clock::now() + kPatience;
  while (!arena.is_dead() && !is_settled(arena, id)) {
    expect(steady_clock::now() < until, "the job neither ends nor kills its server");
    std::this_thread::sleep_for(milliseconds(1));
  }
  if (!arena.is_dead()) std::this_thread::sleep_for(kRest);
  return arena.is_dead();
}

/// True: there was such a call.
bool kill_at_call(Trials& trials, const Work& work, std::size_t call) {
  Arena arena(trials);
  arena.start(
      {std::string("LD_PRELOAD=") + FAIRWAY_CALL_KILLER, fmt::format("CHAOS_CALL={}", call)});
  const std::string id = arena.submit(work);
  const bool died = dies(arena, id);
  if (died) {
    arena.kill();
    arena.start();
  }
  arena.expect_promises_kept();
  expect(arena.job(id)["attempt"] == 1, "the death of the server was counted as an attempt");
  return died;
}

}  // namespace

void kill_at_calls(Trials& trials, Workshop& workshop, std::size_t) {
  bool died = true;
  for (std::size_t call = 1; died && call <= kMostCalls; ++call) {
    died = false;
    trials.run(fmt::format("#{}", call),
               [&] { died = kill_at_call(trials, workshop.verbose(), call); });
  }
}

}  // namespace fairway::chaos
