#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/worker_limits.h"
#include "server/os/child_process.h"
#include "server/os/event_flag.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// Tells a program file from the one that took its place.
struct ProgramVersion {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t changed = 0;  ///< nanoseconds
  std::int64_t bytes = -1;   ///< −1: it cannot be looked at

  bool operator==(const ProgramVersion&) const = default;
};

/// A worker process that waits for its order.
struct WaitingWorker {
  ChildProcess process;
  UniqueFd socket;
  ProgramVersion version;
  bool was_kept = false;  ///< it waited in the pool, and may have died there
};

/// Starts workers ahead of their orders, so that a job waits for none: `kept` of them stand by,
/// each confined but for its filter, and the oldest is taken first. One that dies while it waits,
/// or whose program file was replaced, is replaced by a new one. Any thread may call.
class WorkerPool {
 public:
  /// `limits`: the most that a job may have. With `kept` = 0 every worker is started when it is
  /// taken. `log` must outlive the pool.
  WorkerPool(std::filesystem::path program, const WorkerLimits& limits, std::size_t kept,
             const Log& log);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  /// Workers end with the thread that started them (PDEATHSIG): the pool must outlive all that were
  /// taken from it.
  ~WorkerPool();

  /// Starts the first workers and keeps their number from then on; from a thread that outlives all
  /// work. Errors: unavailable.
  Result<void> start();

  /// The worker that has waited longest, or, where none does, a new one. Errors: unavailable, io
  /// (no process could be started).
  Result<WaitingWorker> take();

  /// Ends those that wait, at once, and keeps no more.
  void close();

 private:
  Result<WaitingWorker> spawn() const;
  void keep(const std::stop_token& stop);
  void drop_unfit();
  void fill();
  bool wants_one();
  void note_failure(const char* event, const std::string& how);
  void wait();

  const std::filesystem::path program_;
  const WorkerLimits limits_;
  const std::size_t kept_;
  const Log& log_;

  std::mutex mutex_;
  std::deque<WaitingWorker> waiting_;                 ///< guarded by mutex_; oldest first
  bool closed_ = false;                               ///< guarded by mutex_
  std::chrono::steady_clock::time_point not_before_;  ///< guarded by mutex_; of the next start
  std::chrono::milliseconds pause_{0};                ///< guarded by mutex_; after the next failure

  std::optional<EventFlag> changed_;  ///< the thread looks again; set by start()
  std::jthread thread_;
};

}  // namespace fairway
