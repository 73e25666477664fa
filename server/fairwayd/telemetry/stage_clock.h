#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fairway {

/// Names of stages and how long a job was in each, in the order of their beginning.
using StageTimes = std::vector<std::pair<std::string, std::chrono::microseconds>>;

/// Turns the progress of a job into the time of its stages. A stage that is entered again, as with
/// several meshes, is continued; names that no worker of ours says count as "other".
class StageClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// The stage that the job is in now; the one at hand changes nothing.
  void enter(std::string_view stage, Clock::time_point now = Clock::now());

  /// Ends the stage at hand and gives all times.
  StageTimes finish(Clock::time_point now = Clock::now());

 private:
  std::string stage_;  ///< empty before the first
  Clock::time_point since_;
  StageTimes times_;
};

}  // namespace fairway
