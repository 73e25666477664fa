// Jobs as clients see them: documents, lists, and their end.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/job_version.h"
#include "server/fairwayd/store/job_facts.h"
#include "server/fairwayd/work/job_log.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxListed = 200;

/// A whole number of the query within its bounds.
template <class Number>
bool read_number(const std::string& text, Number low, Number high, Number& out) {
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, out);
  return status == std::errc() && stop == end && out >= low && out <= high;
}

/// "?state=…&label=…&limit=…&cursor=…"; anything else is refused.
Result<JobQuery> job_query(const HttpRequest& request) {
  JobQuery query;
  for (const auto& [name, value] : request.query) {
    if (name == "state" && (query.state = job_state_of_name(value))) continue;
    if (name == "label" && is_label(value) && query.labels.size() < kMaxLabels) {
      query.labels.push_back(value);
      continue;
    }
    if (name == "limit" && read_number<std::size_t>(value, 1, kMaxListed, query.limit)) continue;
    std::int64_t before = 0;
    if (name == "cursor" && read_number<std::int64_t>(value, 1, INT64_MAX, before)) {
      query.before = before;
      continue;
    }
    return Error{ErrorCode::bad_request,
                 fmt::format("The list takes state=<a job state>, label=<a label> (several: jobs "
                             "with all of them), limit=1…{} and cursor=<next of the list before>.",
                             kMaxListed)};
  }
  std::sort(query.labels.begin(), query.labels.end());
  query.labels.erase(std::unique(query.labels.begin(), query.labels.end()), query.labels.end());
  return query;
}

Json counts_document(const StateCounts& counts) {
  Json document = Json::object();
  for (const auto& [state, count] : counts) document[std::string(name_of(state))] = count;
  return document;
}

}  // namespace

HttpResponse Api::list_jobs(const std::string& tenant, const HttpRequest& request) {
  auto query = job_query(request);
  if (!query) return refuse(query.error());
  query->tenant = tenant;
  const auto page = jobs_.list(*query);
  if (!page) return refuse(page.error());
  const auto counts = jobs_.count(*query);
  if (!counts) return refuse(counts.error());
  Json documents = Json::array();
  for (const Job& job : page->jobs) documents.push_back(document_of(job));
  Json list{{"jobs", std::move(documents)}, {"counts", counts_document(*counts)}};
  if (page->has_more) list["next"] = std::to_string(page->jobs.back().number);
  return json_response(list);
}

HttpResponse Api::cancel_job(const JobName& name) {
  const auto job = cancel(name);
  return job ? job_response(*job, 200) : refuse(job.error());
}

HttpResponse Api::retry_job(const JobName& name) {
  const auto old = jobs_.find(name);
  if (!old) return refuse(old.error());
  // Whatever the state says: without its input no job is done again.
  if (const auto input = blobs_.open(old->input.key); !input) return refuse(input.error());
  const auto job = jobs_.retry(name, options_.queue_limit);
  if (!job) return refuse(job.error());
  about(log_, *job).write(LogLevel::info, "job_retried");
  board_.announce();
  supervisor_.wake();
  return job_response(*job, 202);
}

HttpResponse Api::delete_job(const JobName& name) {
  const auto ended = cancel(name);
  if (!ended) return refuse(ended.error());
  const auto expiry = jobs_.expire(name);
  if (!expiry) return refuse(expiry.error());
  for (const std::string& key : expiry->blobs) remove_blob(key);
  board_.announce();
  return job_response(expiry->job, 200);
}

Result<Job> Api::cancel(const JobName& name) {
  const auto before = jobs_.find(name);
  auto job = jobs_.cancel(name);
  if (!job || job->state != JobState::canceled) return job;
  if (before && !is_final(before->state)) {
    const UnixMillis end = job->finished.value_or(job->created);
    metrics_.job_ended(problem_kind(ErrorCode::canceled).slug,
                       std::chrono::milliseconds(end - job->created));
  }
  supervisor_.interrupt(job->number);
  about(log_, *job).write(LogLevel::info, "job_canceled");
  board_.announce();
  return job;
}

/// One that cannot be removed is swept at the next start.
void Api::remove_blob(const std::string& key) {
  if (auto removed = blobs_.remove(key); !removed) {
    log_.write(LogLevel::warning, "blob_not_removed",
               {{"key", key}, {"reason", removed.error().message}});
  }
}

Json Api::document_of(const Job& job) {
  JobFacts facts = facts_of(job);
  // Both documents were written by this program; one that cannot be read back is shown as null.
  if (auto parameters = parse_json(job.parameters)) facts.parameters = std::move(*parameters);
  if (!job.report.empty()) {
    if (auto report = parse_json(job.report)) facts.report = std::move(*report);
  }
  if (job.state == JobState::queued) {
    if (const auto before = jobs_.jobs_before(job)) facts.queue_position = *before + 1;
  }
  facts.progress = board_.progress(job.number);
  return job_document(facts);
}

HttpResponse Api::job_response(const Job& job, int status) {
  HttpResponse response = json_response(document_of(job), status);
  add_version(response, job);
  if (status == 202) response.headers.emplace_back("Location", "/v1/jobs/" + job.id);
  return response;
}

}  // namespace fairway
