#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace fairway {

/// How often each tenant may submit: a bucket of `per_minute` submits that fills up evenly.
/// Of this process alone; a restart fills all buckets.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// What became of one submit.
  struct Verdict {
    bool allowed = true;
    std::uint64_t left = 0;         ///< submits that may follow at once
    std::chrono::seconds reset{0};  ///< until there is one more; at least 1 where none is left
  };

  /// `per_minute`: 0 = any number.
  explicit RateLimit(std::uint64_t per_minute) : per_minute_(per_minute) {}

  bool is_on() const { return per_minute_ > 0; }
  std::uint64_t per_minute() const { return per_minute_; }

  /// Takes one submit, if there is one.
  Verdict take(const std::string& tenant, Clock::time_point now = Clock::now());

 private:
  struct Bucket {
    double level = 0;  ///< submits
    Clock::time_point at;
  };

  const std::uint64_t per_minute_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace fairway
