#include "server/fairwayd/work/service_metrics.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace fairway {
namespace {

using Kind = MetricFamily::Kind;

const std::vector<double> kSeconds = {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5,
                                      1,     2.5,    5,     10,   30,    60,   120, 300,  600};
constexpr double kMebi = 1024.0 * 1024.0;
const std::vector<double> kMemory = {16 * kMebi,   32 * kMebi,   64 * kMebi,
                                     128 * kMebi,  256 * kMebi,  512 * kMebi,
                                     1024 * kMebi, 2048 * kMebi, 4096 * kMebi};

constexpr std::array<std::string_view, 9> kMethods = {
    "GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "CONNECT", "TRACE"};

/// A client may invent methods.
std::string method_label(const std::string& method) {
  const bool known = std::find(kMethods.begin(), kMethods.end(), method) != kMethods.end();
  return known ? method : "other";
}

template <class Period>
double seconds(std::chrono::duration<std::int64_t, Period> time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

ServiceMetrics::ServiceMetrics(std::string_view version)
    : build_({Kind::gauge, "fairway_build_info", "Which fairwayd runs.", {"version"}, {}}),
      jobs_({Kind::gauge, "fairway_jobs", "Jobs in the store by state.", {"state"}, {}}),
      queue_depth_({Kind::gauge, "fairway_queue_depth", "Jobs that wait for a worker.", {}, {}}),
      queue_age_({Kind::gauge,
                  "fairway_queue_oldest_age_seconds",
                  "How long the oldest waiting job has been waiting; 0 where none does.",
                  {},
                  {}}),
      jobs_ended_(
          {Kind::counter,
           "fairway_jobs_ended_total",
           "Jobs that came to their end, by outcome: succeeded, or the code of the problem.",
           {"outcome"},
           {}}),
      job_time_({Kind::histogram,
                 "fairway_job_duration_seconds",
                 "From the submit of a job to its end.",
                 {},
                 kSeconds}),
      run_time_({Kind::histogram,
                 "fairway_run_duration_seconds",
                 "How long the worker of a successful job ran.",
                 {},
                 kSeconds}),
      stage_time_({Kind::histogram,
                   "fairway_stage_duration_seconds",
                   "How long successful jobs were in each stage.",
                   {"stage"},
                   kSeconds}),
      worker_memory_({Kind::histogram,
                      "fairway_worker_peak_resident_bytes",
                      "Most memory that a worker process had resident.",
                      {},
                      kMemory}),
      inspections_({Kind::counter,
                    "fairway_inspections_total",
                    "Inspections by outcome: succeeded, or the code of the problem.",
                    {"outcome"},
                    {}}),
      free_bytes_(
          {Kind::gauge, "fairway_storage_free_bytes", "Space left where meshes are kept.", {}, {}}),
      webhook_attempts_(
          {Kind::counter,
           "fairway_webhook_attempts_total",
           "Attempts to tell a webhook, by outcome: delivered, retried (later), dead.",
           {"outcome"},
           {}}),
      webhooks_pending_({Kind::gauge,
                         "fairway_webhook_deliveries_pending",
                         "Deliveries that their webhooks have not taken yet.",
                         {},
                         {}}),
      webhooks_age_({Kind::gauge,
                     "fairway_webhook_oldest_pending_age_seconds",
                     "How long the oldest of them has been pending; 0 where none is.",
                     {},
                     {}}),
      requests_({Kind::counter,
                 "fairway_http_requests_total",
                 "Answered requests by route, method and class of status.",
                 {"route", "method", "status"},
                 {}}),
      request_time_({Kind::histogram,
                     "fairway_http_request_duration_seconds",
                     "From a request's head to the end of its answer.",
                     {"route"},
                     kSeconds}),
      bytes_in_({Kind::counter,
                 "fairway_http_received_bytes_total",
                 "Bytes of requests, heads included.",
                 {},
                 {}}),
      bytes_out_({Kind::counter,
                  "fairway_http_sent_bytes_total",
                  "Bytes of answers, heads included.",
                  {},
                  {}}),
      connections_(
          {Kind::gauge, "fairway_http_connections", "Connections that are open.", {}, {}}) {
  build_.set(1, {std::string(version)});
  connections_.set(0);
}

void ServiceMetrics::answered(const HttpExchange& exchange, std::string_view route) {
  requests_.add(1, {std::string(route), method_label(exchange.method),
                    fmt::format("{}xx", exchange.status / 100)});
  request_time_.observe(seconds(exchange.took), {std::string(route)});
  bytes_in_.add(static_cast<double>(exchange.bytes_in));
  bytes_out_.add(static_cast<double>(exchange.bytes_out));
}

void ServiceMetrics::job_ended(std::string_view outcome, std::chrono::milliseconds since_submit) {
  jobs_ended_.add(1, {std::string(outcome)});
  job_time_.observe(seconds(since_submit));
}

void ServiceMetrics::job_ran(std::chrono::microseconds took, const StageTimes& stages) {
  run_time_.observe(seconds(took));
  for (const auto& [stage, time] : stages) stage_time_.observe(seconds(time), {stage});
}

void ServiceMetrics::inspected(std::string_view outcome) {
  inspections_.add(1, {std::string(outcome)});
}

void ServiceMetrics::webhook_attempted(std::string_view outcome) {
  webhook_attempts_.add(1, {std::string(outcome)});
}

void ServiceMetrics::worker_ended(std::uint64_t peak_resident_bytes) {
  worker_memory_.observe(static_cast<double>(peak_resident_bytes));
}

void ServiceMetrics::set_jobs(const JobCounts& jobs, UnixMillis now) {
  for (const auto& [state, count] : jobs.by_state) {
    jobs_.set(static_cast<double>(count), {std::string(name_of(state))});
    if (state == JobState::queued) queue_depth_.set(static_cast<double>(count));
  }
  const UnixMillis age = now - jobs.oldest_queued.value_or(now);
  queue_age_.set(static_cast<double>(std::max<UnixMillis>(age, 0)) / 1000.0);
}

void ServiceMetrics::set_outbox(const OutboxCounts& outbox, UnixMillis now) {
  webhooks_pending_.set(static_cast<double>(outbox.pending));
  const UnixMillis age = now - outbox.oldest_pending.value_or(now);
  webhooks_age_.set(static_cast<double>(std::max<UnixMillis>(age, 0)) / 1000.0);
}

std::string ServiceMetrics::text(const std::optional<JobCounts>& jobs, UnixMillis now,
                                 const std::optional<std::uint64_t>& free_bytes,
                                 const std::optional<OutboxCounts>& outbox) {
  if (jobs) set_jobs(*jobs, now);
  if (free_bytes) free_bytes_.set(static_cast<double>(*free_bytes));
  std::string text;
  if (jobs) text += jobs_.text() + queue_depth_.text() + queue_age_.text();
  if (free_bytes) text += free_bytes_.text();
  if (outbox) {
    set_outbox(*outbox, now);
    text += webhooks_pending_.text() + webhooks_age_.text();
  }
  for (const MetricFamily* family :
       {&build_, &jobs_ended_, &job_time_, &run_time_, &stage_time_, &worker_memory_, &inspections_,
        &webhook_attempts_, &requests_, &request_time_, &bytes_in_, &bytes_out_, &connections_}) {
    text += family->text();
  }
  return text;
}

}  // namespace fairway
