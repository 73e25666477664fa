#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/inspection_task.h"
#include "server/fairwayd/work/job_board.h"
#include "server/fairwayd/work/service_metrics.h"
#include "server/fairwayd/work/worker_run.h"
#include "server/os/event_flag.h"

namespace fairway {

struct SupervisorOptions {
  std::size_t slots = 1;
  std::string owner = "local";  ///< this worker host's lasting name in the store
  WorkerLimits limits;
  std::chrono::milliseconds lease{30000};
  std::chrono::milliseconds heartbeat{10000};
};

/// Runs the jobs of the store and inspections, at most `slots` at a time, each in a worker process
/// of its own. One thread per slot: claim, run, put the result into the blob store, commit the
/// state last. A slot takes inspections, which are short and waited for, and jobs in turns.
class Supervisor {
 public:
  /// All references must outlive the supervisor.
  Supervisor(JobStore& jobs, BlobStore& blobs, JobBoard& board, WorkerPool& workers,
             ServiceMetrics& metrics, const Log& log, SupervisorOptions options);
  /// As stop().
  ~Supervisor();

  /// Starts the slots. Errors: unavailable.
  Result<void> start();

  /// Begins nothing new. What runs goes on; `idle` is raised once nothing does. It must outlive the
  /// supervisor.
  void drain(const EventFlag& idle);

  /// Kills the running workers, hands their jobs back to the queue, ends the slots. Idempotent.
  void stop();

  /// There may be work: a slot looks at once instead of within a second.
  void wake();

  /// Puts an inspection in line, where fewer than `places` stand. Where the supervisor stops first,
  /// it is never answered. Errors: queue_full.
  Result<void> inspect(std::shared_ptr<InspectionTask> task, std::size_t places);
  /// Nobody waits for it any more: it leaves the line, or its worker is killed within a second.
  void withdraw(const std::shared_ptr<InspectionTask>& task);
  /// How many inspections no slot has begun.
  std::size_t waiting_inspections();

  /// The job was canceled in the store: if it runs here, its worker is killed at once (elsewhere
  /// the next heartbeat tells).
  void interrupt(std::int64_t job);

 private:
  struct Slot {
    explicit Slot(EventFlag flag) : interrupt(std::move(flag)) {}

    const EventFlag interrupt;
    std::mutex mutex;
    std::int64_t job = 0;   ///< its number; 0 while idle
    bool canceled = false;  ///< the job was canceled while it ran here
    std::jthread thread;
  };

  void serve(Slot& slot, std::stop_token stop);
  bool is_draining();
  void leave();
  void wait_for_work(std::stop_token stop);
  void serve_inspection(Slot& slot, const std::stop_token& stop);
  void run(Slot& slot, const Claim& claim, std::stop_token stop);
  void execute(Slot& slot, const Claim& claim, std::stop_token stop);
  Result<WorkerEnd> run_process(Slot& slot, const Claim& claim, BlobDraft& output,
                                std::stop_token stop);
  Result<WorkerEnd> follow(Slot& slot, const Claim& claim, const WorkerTask& task,
                           const std::stop_token& stop);
  bool keep_going(Slot& slot, const Claim& claim, std::chrono::steady_clock::time_point& next_beat,
                  const std::stop_token& stop);
  void settle(const Claim& claim, WorkerEnd end, BlobDraft& output, const std::stop_token& stop);
  void succeed(const Claim& claim, const Finished& finished, BlobDraft& output,
               const std::stop_token& stop);
  bool disk_is_short(const Job& job);
  void try_later(const Claim& claim, const Error& error, const std::stop_token& stop);
  void fail(const Claim& claim, const Error& error);
  void lose_worker(const Claim& claim, const WorkerDied& death);
  void hand_back(const Claim& claim);
  void conclude(const Claim& claim, const Result<Job>& written);
  void pause(std::chrono::milliseconds time, std::stop_token stop);

  JobStore& jobs_;
  BlobStore& blobs_;
  JobBoard& board_;
  WorkerPool& workers_;
  ServiceMetrics& metrics_;
  const Log& log_;
  const SupervisorOptions options_;

  std::mutex mutex_;
  std::condition_variable_any work_;
  std::size_t wakeups_ = 0;  ///< guarded by mutex_; one slot looks for work for each
  std::deque<std::shared_ptr<InspectionTask>> inspections_;  ///< guarded by mutex_; oldest first
  std::size_t serving_ = 0;          ///< guarded by mutex_; slots that have not left
  const EventFlag* idle_ = nullptr;  ///< guarded by mutex_; not null once draining

  std::vector<std::unique_ptr<Slot>> slots_;  ///< changed by start() and stop() only
};

}  // namespace fairway
