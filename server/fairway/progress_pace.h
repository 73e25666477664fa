#pragma once

#include <chrono>
#include <string>

#include "proto/messages/worker_protocol.h"

namespace fairway {

/// Which progress of a job is worth telling: every stage, and within one no more than anybody can
/// follow. A small mesh takes a step in less time than the one who listens needs to hear of it.
class ProgressPace {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::milliseconds kPace{20};

  /// Whether to tell it now; then it is taken as told.
  bool admits(const Progress& progress, Clock::time_point now = Clock::now()) {
    if (progress.stage == stage_ && now - told_ < kPace) return false;
    stage_ = progress.stage;
    told_ = now;
    return true;
  }

 private:
  std::string stage_;
  Clock::time_point told_{};
};

}  // namespace fairway
