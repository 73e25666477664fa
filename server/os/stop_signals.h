#pragma once

#include <chrono>
#include <optional>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// SIGTERM and SIGINT as something to wait for, instead of handlers.
class StopSignals {
 public:
  /// Blocks them for this thread and all that it starts later. Errors: unavailable.
  static Result<StopSignals> block();

  enum class Woken { signal, flag, timeout };

  /// Waits for the next signal, for `flag` (a descriptor that becomes readable; -1 = none), or for
  /// the end of `time`, where one is given. A signal that came before is not lost.
  Woken wait(int flag = -1, std::optional<std::chrono::milliseconds> time = {}) const;

 private:
  explicit StopSignals(UniqueFd fd) : fd_(std::move(fd)) {}

  UniqueFd fd_;  ///< a signalfd
};

}  // namespace fairway
