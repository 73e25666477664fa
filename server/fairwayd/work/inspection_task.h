#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

#include "core/result.h"
#include "proto/messages/json.h"
#include "proto/messages/worker_protocol.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/service_metrics.h"
#include "server/fairwayd/work/worker_run.h"
#include "server/os/event_flag.h"

namespace fairway {

/// An upload that waits for its inspection, with the client that waits for the answer. It lives in
/// memory and the spool only: nothing of it is committed, and nothing is left once both sides have
/// let go.
class InspectionTask {
 public:
  InspectionTask(std::unique_ptr<BlobDraft> input, WorkerOrder order)
      : input_(std::move(input)), order_(std::move(order)) {}

  int input() const { return input_->descriptor(); }
  const WorkerOrder& order() const { return order_; }

  /// The client has gone: a worker at it is killed within a second.
  void abandon() { abandoned_ = true; }
  bool is_abandoned() const { return abandoned_; }

  /// Gives the answer, once: the inspection document, or why there is none.
  void answer(Result<Json> answer);
  /// Blocks until there is an answer, the time is up, or a stop is requested; gives the answer, if
  /// there is one, away.
  std::optional<Result<Json>> wait(std::chrono::milliseconds time, std::stop_token stop);

 private:
  const std::unique_ptr<BlobDraft> input_;
  const WorkerOrder order_;
  std::atomic<bool> abandoned_ = false;

  std::mutex mutex_;
  std::condition_variable_any answered_;
  std::optional<Result<Json>> answer_;
};

/// What an inspection runs with.
struct InspectionSetting {
  WorkerPool& workers;
  const WorkerLimits& limits;
  const EventFlag& interrupt;  ///< raised when a stop is requested
  ServiceMetrics& metrics;
  const Log& log;
};

/// Runs a worker on a task, and once more where it dies, as jobs do; answers the task.
void run_inspection(InspectionTask& task, const InspectionSetting& setting, std::stop_token stop);

}  // namespace fairway
