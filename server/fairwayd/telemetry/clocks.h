#pragma once

#include <chrono>
#include <cstdint>

#include "proto/messages/job_document.h"

namespace fairway {

/// The wall clock: for people, never for deadlines.
inline UnixMillis wall_clock() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Milliseconds of a clock that nobody can set; restarts with the machine.
inline std::int64_t monotonic_millis() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace fairway
