#include "server/fairwayd/work/job_wait.h"

#include <algorithm>
#include <utility>

namespace fairway {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// What ends a wait besides the job; `reached` where nothing does.
WaitEnd other_end(const JobWatch& watch, steady_clock::time_point until) {
  if (!watch.client_is_there()) return WaitEnd::client_gone;
  if (watch.stop.stop_requested()) return WaitEnd::stopping;
  return steady_clock::now() >= until ? WaitEnd::time_up : WaitEnd::reached;
}

}  // namespace

Result<Waited> wait_for_job(const JobWatch& watch, std::int64_t number,
                            steady_clock::time_point until,
                            const std::function<bool(const Job&)>& reached) {
  while (true) {
    const std::uint64_t turn = watch.board.turn();
    auto job = watch.jobs.find(number);
    if (!job) return job.error();
    if (reached(*job)) return Waited{WaitEnd::reached, *std::move(job)};
    const auto look_again = steady_clock::now() + kLookForChange;
    do {
      const WaitEnd end = other_end(watch, until);
      if (end != WaitEnd::reached) return Waited{end, *std::move(job)};
      const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
      watch.board.wait(turn, std::min(kLookForClient, left), watch.stop);
    } while (watch.board.turn() == turn && steady_clock::now() < look_again);
  }
}

}  // namespace fairway
