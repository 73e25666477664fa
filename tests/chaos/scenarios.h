#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "tests/chaos/trials.h"
#include "tests/chaos/work.h"

namespace fairway::chaos {

/// A way to disturb the service. `run` runs `count` trials.
struct Scenario {
  std::string_view name;
  std::size_t count;  ///< of trials, at full scale
  bool scales;        ///< whether the count follows --scale
  void (*run)(Trials& trials, Workshop& workshop, std::size_t count);
  std::string_view what;
};

/// All of them.
std::span<const Scenario> scenarios();

void kill_during_upload(Trials& trials, Workshop& workshop, std::size_t count);
void kill_after_accepting(Trials& trials, Workshop& workshop, std::size_t count);
void kill_during_job(Trials& trials, Workshop& workshop, std::size_t count);
void kill_worker(Trials& trials, Workshop& workshop, std::size_t count);

/// One trial for each pass of each row of kKillPoints.
void kill_at_points(Trials& trials, Workshop& workshop, std::size_t count);
std::size_t kill_point_trials();

/// One trial for each call that changes a file between the end of a worker and that of its job.
void kill_at_calls(Trials& trials, Workshop& workshop, std::size_t count);

void stop_worker(Trials& trials, Workshop& workshop, std::size_t count);
void stop_server(Trials& trials, Workshop& workshop, std::size_t count);
/// One trial for each of some points between a claim and its result.
void lose_lease(Trials& trials, Workshop& workshop, std::size_t count);

void restart_with_queue(Trials& trials, Workshop& workshop, std::size_t count);
void hold_connections(Trials& trials, Workshop& workshop, std::size_t count);
void crowd(Trials& trials, Workshop& workshop, std::size_t count);

}  // namespace fairway::chaos
