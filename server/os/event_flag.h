#pragma once

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A flag that poll() can wait for (an eventfd). Any thread may raise or lower it.
class EventFlag {
 public:
  /// Errors: unavailable (no descriptor left).
  static Result<EventFlag> create();

  void raise() const;
  void lower() const;
  bool is_raised() const;
  /// Readable while the flag is raised.
  int descriptor() const { return fd_.get(); }

 private:
  explicit EventFlag(UniqueFd fd) : fd_(std::move(fd)) {}

  UniqueFd fd_;
};

}  // namespace fairway
