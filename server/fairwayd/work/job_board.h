#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "proto/messages/worker_protocol.h"
#include "server/fairwayd/telemetry/stage_clock.h"

namespace fairway {

/// What this server knows about jobs beyond the store: the progress of those it runs (never
/// committed), and a wake-up for those who wait for a change. It only says that something changed;
/// what, the JobStore tells.
class JobBoard {
 public:
  // Jobs are named by their number in the store.

  void post(std::int64_t job, const Progress& progress);
  /// The job runs here no longer.
  void forget(std::int64_t job);
  std::optional<Progress> progress(std::int64_t job) const;

  /// How long a job that ended well here was in each stage; kept of the last thousand.
  void keep_stages(std::int64_t job, StageTimes stages);
  /// Empty where they are not known.
  StageTimes stages(std::int64_t job) const;

  /// Some job's state was written. Wakes all who wait.
  void announce();

  /// A number that grows with every announce(). Read it before reading the store.
  std::uint64_t turn() const;
  /// Blocks until turn() differs from `seen`, the time is up, or a stop is requested.
  void wait(std::uint64_t seen, std::chrono::milliseconds time, std::stop_token stop) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  std::map<std::int64_t, Progress> progress_;
  std::map<std::int64_t, StageTimes> stages_;
  std::deque<std::int64_t> stages_kept_;  ///< the keys of stages_, oldest first
  std::uint64_t turn_ = 0;
};

}  // namespace fairway
