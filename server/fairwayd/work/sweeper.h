#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/uploads/resumable_uploads.h"
#include "server/fairwayd/work/job_board.h"

namespace fairway {

/// Removes what is kept no longer: payloads of jobs whose time is over, and, much later, the jobs
/// themselves; uploads that came to nothing.
class Sweeper {
 public:
  struct Options {
    std::chrono::milliseconds every = std::chrono::seconds(5);
    std::chrono::milliseconds forget = std::chrono::hours(24 * 30);  ///< after the end of a job
  };

  /// All references must outlive the sweeper. Starts to sweep.
  Sweeper(JobStore& jobs, BlobStore& blobs, ResumableUploads& uploads, JobBoard& board,
          const Log& log, const Options& options);

  /// One round: all that is due now. A failure is logged; the next round tries again.
  void sweep();

 private:
  Result<std::size_t> expire_due();
  void run(const std::stop_token& stop);

  JobStore& jobs_;
  BlobStore& blobs_;
  ResumableUploads& uploads_;
  JobBoard& board_;
  const Log& log_;
  const Options options_;

  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;
};

}  // namespace fairway
