#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace fairway {

/// How many requests may wait for changes at once: each holds a thread, and others must get one.
class WatchLimit {
 public:
  explicit WatchLimit(std::size_t most) : most_(most) {}

  /// Given back when the last copy is gone; must not outlive the limit.
  using Place = std::shared_ptr<const void>;

  /// Null where all places are taken.
  Place take() {
    if (taken_.fetch_add(1) >= most_) {
      --taken_;
      return nullptr;
    }
    return {this, [this](const void*) { --taken_; }};
  }

 private:
  const std::size_t most_;
  std::atomic<std::size_t> taken_{0};
};

}  // namespace fairway
