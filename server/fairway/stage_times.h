#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fairway {

/// How long each stage of a run took.
class StageTimes {
 public:
  /// The first stage, "start", is what the process has computed so far.
  StageTimes();

  /// The stage that begins now; the name of the one at hand changes nothing.
  void begin(std::string_view stage);

  /// Ends the stage at hand and prints a line of milliseconds per stage to standard error.
  void print();

 private:
  using Clock = std::chrono::steady_clock;

  void end();

  std::string stage_;
  Clock::time_point since_ = Clock::now();
  std::vector<std::pair<std::string, double>> milliseconds_;
};

}  // namespace fairway
