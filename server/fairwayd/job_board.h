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
#include "server/fairwayd/stage_clock.h"

namespace fairway {

/// What this server knows about jobs beyond the store: the progress of those it runs (never
/// committed), and a wake-up for those who wait for a change. It only says that something changed;
/// what, the JobStore tells.
class JobBoard {
 public:
  void post(const std::string& job_id, const Progress& progress);
  /// The job runs here no longer.
  void forget(const std::string& job_id);
  std::optional<Progress> progress(const std::string& job_id) const;

  /// How long a job that ended well here was in each stage; kept of the last thousand.
  void keep_stages(const std::string& job_id, StageTimes stages);
  /// Empty where they are not known.
  StageTimes stages(const std::string& job_id) const;

  /// Some job's state was written. Wakes all who wait.
  void announce();

  /// A number that grows with every announce(). Read it before reading the store.
  std::uint64_t turn() const;
  /// Blocks until turn() differs from `seen`, the time is up, or a stop is requested.
  void wait(std::uint64_t seen, std::chrono::milliseconds time, std::stop_token stop) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  std::map<std::string, Progress> progress_;
  std::map<std::string, StageTimes> stages_;
  std::deque<std::string> stages_kept_;  ///< the keys of stages_, oldest first
  std::uint64_t turn_ = 0;
};

}  // namespace fairway
