#pragma once

#include <chrono>
#include <cstdint>

#include "proto/messages/format.h"

namespace fairway {

/// Walls around one worker process.
struct WorkerLimits {
  std::uint64_t address_space = std::uint64_t{4} << 30;  ///< bytes; 0 = none
  std::chrono::seconds cpu{600};                         ///< of all its threads together
  std::chrono::seconds deadline{300};                    ///< wall clock, then SIGKILL
  /// Largest result, bytes; 0 = as large as `address_space`, where it stands before it is written.
  std::uint64_t result_bytes = 0;
};

/// Processor time for a job that must end within `deadline`. A backstop: a worker has one thread,
/// so the deadline comes first unless nobody watches it.
constexpr std::chrono::seconds processor_time_within(std::chrono::seconds deadline) {
  return deadline + std::chrono::seconds(10);
}

/// The limits of a job with a mesh file of so many bytes: what the server gives to any, or less
/// where the format bounds what the file can become.
WorkerLimits limits_for(WorkerLimits limits, Format format, std::uint64_t bytes);

}  // namespace fairway
