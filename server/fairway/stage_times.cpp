#include "server/fairway/stage_times.h"

#include <cstdio>
#include <ctime>

#include <fmt/format.h>

namespace fairway {

StageTimes::StageTimes() {
  milliseconds_.emplace_back("start", 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
}

void StageTimes::begin(std::string_view stage) {
  if (stage == stage_) return;
  end();
  stage_ = stage;
}

void StageTimes::end() {
  const Clock::time_point now = Clock::now();
  if (!stage_.empty()) {
    const std::chrono::duration<double, std::milli> took = now - since_;
    milliseconds_.emplace_back(stage_, took.count());
  }
  since_ = now;
}

void StageTimes::print() {
  end();
  std::string line;
  double sum = 0.0;
  for (const auto& [stage, time] : milliseconds_) {
    line += fmt::format("{} {:.1f}, ", stage, time);
    sum += time;
  }
  fmt::print(stderr, "{}total {:.1f} ms\n", line, sum);
}

}  // namespace fairway
