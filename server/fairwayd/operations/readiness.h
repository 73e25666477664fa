#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/worker_pool.h"

namespace fairway {

/// One thing that the service needs for work.
struct ReadinessCheck {
  std::string_view name;
  bool ok = false;
  std::string detail;  ///< for clients, where not ok; what the system said is in the log only
};

struct ReadinessOptions {
  std::filesystem::path worker;  ///< the `fairway` program
  WorkerLimits limits;           ///< of the canary
  std::uint64_t min_free = 0;    ///< bytes
};

/// Finds out whether the service can work, by doing it. Every answer holds for some seconds, and
/// one request at a time looks anew, so that asking cannot load the machine.
class Readiness {
 public:
  using Clock = std::chrono::steady_clock;

  /// All references must outlive it; `stop` ends a canary or a self-test that runs.
  Readiness(JobStore& jobs, BlobStore& blobs, WorkerPool& workers, const Log& log,
            ReadinessOptions options, std::stop_token stop);

  /// store: a row can be written; data: a file can be written; disk: enough of it is left;
  /// worker: the program starts; sandbox: its self-test shows that forbidden calls end it; and,
  /// where asked for, canary: a worker denoises a mesh.
  std::vector<ReadinessCheck> check(bool with_canary);

  /// Begins with what takes longest, the self-test, so that the first who asks need not wait for
  /// it.
  void look_ahead() { ask(sandbox_); }

 private:
  struct Probe {
    std::string_view name;
    std::string_view complaint;  ///< the detail for clients
    std::chrono::seconds holds;  ///< a bad answer for five seconds at most
    std::function<Result<void>()> look;

    std::mutex mutex;
    std::optional<bool> ok;  ///< as of `looked`
    Clock::time_point looked;
  };

  ReadinessCheck ask(Probe& probe);
  Result<void> write_file();
  Result<void> check_disk();
  Result<void> start_worker() const;
  Result<void> test_sandbox();

  JobStore& jobs_;
  BlobStore& blobs_;
  WorkerPool& workers_;
  const Log& log_;
  const ReadinessOptions options_;
  const std::stop_token stop_;

  Probe store_;
  Probe data_;
  Probe disk_;
  Probe worker_;
  Probe sandbox_;
  Probe canary_;

  std::string sandbox_note_;  ///< last logged; of sandbox_ and under its mutex
};

}  // namespace fairway
