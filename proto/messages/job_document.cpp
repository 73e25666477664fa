#include "proto/messages/job_document.h"

#include <array>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "proto/messages/webhook_url.h"

namespace fairway {
namespace {

constexpr std::array<std::pair<JobState, std::string_view>, 6> kNames{{
    {JobState::queued, "queued"},
    {JobState::running, "running"},
    {JobState::succeeded, "succeeded"},
    {JobState::failed, "failed"},
    {JobState::canceled, "canceled"},
    {JobState::expired, "expired"},
}};

Json payload_json(const PayloadFacts& payload) {
  Json json = {{"bytes", payload.bytes},
               {"media_type", media_type_of(payload.format)},
               {"format", name_of(payload.format)},
               {"sha256", payload.sha256}};
  if (payload.files > 1) json["files"] = payload.files;
  return json;
}

Json progress_json(const Progress& progress) {
  return Json{{"stage", progress.stage},
              {"step", progress.step},
              {"of", progress.of},
              {"fraction", progress.fraction}};
}

Json links_json(const JobFacts& job) {
  const std::string self = "/v1/jobs/" + job.id;
  Json links{{"self", self}, {"events", self + "/events"}};
  if (job.state == JobState::succeeded) links["result"] = self + "/result";
  if (!is_final(job.state)) links["cancel"] = self + "/cancel";
  if (job.state == JobState::failed || job.state == JobState::canceled) {
    links["retry"] = self + "/retry";
  }
  if (job.options.webhook) links["deliveries"] = self + "/deliveries";
  return links;
}

}  // namespace

std::string_view name_of(JobState state) {
  return kNames.at(static_cast<std::size_t>(state)).second;
}

std::optional<JobState> job_state_of_name(std::string_view name) {
  for (const auto& [state, text] : kNames) {
    if (text == name) return state;
  }
  return std::nullopt;
}

std::string rfc3339_utc(UnixMillis time) {
  using namespace std::chrono;
  const sys_time<milliseconds> point{milliseconds(time)};
  const auto midnight = floor<days>(point);
  const year_month_day date{midnight};
  const hh_mm_ss clock{point - midnight};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

Json job_document(const JobFacts& job) {
  Json document{{"id", job.id},
                {"state", name_of(job.state)},
                {"revision", job.revision},
                {"attempt", job.attempt},
                {"created", rfc3339_utc(job.created)}};
  if (job.started) document["started"] = rfc3339_utc(*job.started);
  if (job.finished) document["finished"] = rfc3339_utc(*job.finished);
  if (job.expires) document["expires_at"] = rfc3339_utc(*job.expires);
  if (job.cached) document["cached"] = true;
  if (job.queue_position) document["queue_position"] = *job.queue_position;
  document.update(job_options_document(job.options));
  if (job.options.webhook) document["webhook"]["url"] = shown_url(job.options.webhook->url);
  document["input"] = payload_json(job.input);
  document["parameters"] = job.parameters;
  if (job.state == JobState::running && job.progress) {
    document["progress"] = progress_json(*job.progress);
  }
  if (job.problem) document["problem"] = problem_document(*job.problem);
  if (!job.report.is_null()) document["report"] = job.report;
  if (job.result) document["result"] = payload_json(*job.result);
  document["links"] = links_json(job);
  return document;
}

}  // namespace fairway
