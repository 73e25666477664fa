#include "server/fairwayd/telemetry/stage_clock.h"

#include <algorithm>
#include <array>

namespace fairway {
namespace {

constexpr std::array<std::string_view, 5> kStages = {"decode", "topology", "flow", "curvature",
                                                     "encode"};

}  // namespace

void StageClock::enter(std::string_view stage, Clock::time_point now) {
  if (std::find(kStages.begin(), kStages.end(), stage) == kStages.end()) stage = "other";
  if (stage == stage_) return;
  finish(now);
  stage_ = stage;
  since_ = now;
}

StageTimes StageClock::finish(Clock::time_point now) {
  if (!stage_.empty()) {
    const auto took = std::chrono::duration_cast<std::chrono::microseconds>(now - since_);
    const auto known = std::find_if(times_.begin(), times_.end(),
                                    [this](const auto& time) { return time.first == stage_; });
    if (known == times_.end()) {
      times_.emplace_back(stage_, took);
    } else {
      known->second += took;
    }
  }
  stage_.clear();
  return times_;
}

}  // namespace fairway
