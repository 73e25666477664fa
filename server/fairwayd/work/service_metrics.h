#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/telemetry/metrics.h"
#include "server/fairwayd/telemetry/stage_clock.h"

namespace fairway {

/// What the service counts. Any thread may call.
class ServiceMetrics {
 public:
  explicit ServiceMetrics(std::string_view version);

  /// `route`: a pattern of routes.h, or "none".
  void answered(const HttpExchange& exchange, std::string_view route);
  void connections_changed(int by) { connections_.add(by); }

  /// A job came to its end. `outcome`: "succeeded", or the slug of its problem.
  void job_ended(std::string_view outcome, std::chrono::milliseconds since_submit);
  /// A worker ran a job to a result.
  void job_ran(std::chrono::microseconds took, const StageTimes& stages);
  /// `outcome`: as of job_ended().
  void inspected(std::string_view outcome);
  /// A webhook was tried. `outcome`: "delivered", "retried" or "dead".
  void webhook_attempted(std::string_view outcome);
  /// A worker process was reaped.
  void worker_ended(std::uint64_t peak_resident_bytes);

  /// The whole text of /metrics. What only the stores know is given: nothing where they fail.
  std::string text(const std::optional<JobCounts>& jobs, UnixMillis now,
                   const std::optional<std::uint64_t>& free_bytes,
                   const std::optional<OutboxCounts>& outbox = {});

 private:
  void set_jobs(const JobCounts& jobs, UnixMillis now);
  void set_outbox(const OutboxCounts& outbox, UnixMillis now);

  MetricFamily build_;
  MetricFamily jobs_;
  MetricFamily queue_depth_;
  MetricFamily queue_age_;
  MetricFamily jobs_ended_;
  MetricFamily job_time_;
  MetricFamily run_time_;
  MetricFamily stage_time_;
  MetricFamily worker_memory_;
  MetricFamily inspections_;
  MetricFamily free_bytes_;
  MetricFamily webhook_attempts_;
  MetricFamily webhooks_pending_;
  MetricFamily webhooks_age_;
  MetricFamily requests_;
  MetricFamily request_time_;
  MetricFamily bytes_in_;
  MetricFamily bytes_out_;
  MetricFamily connections_;
};

}  // namespace fairway
