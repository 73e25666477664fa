// Jobs as clients see them: documents, lists, and their end.

#include <charconv>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/api.h"
#include "server/fairwayd/job_log.h"
#include "server/fairwayd/job_version.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxListed = 200;

/// "?state=…&limit=…"; anything else is refused.
Result<JobQuery> job_query(const HttpRequest& request) {
  JobQuery query;
  for (const auto& [name, value] : request.query) {
    const char* end = value.data() + value.size();
    if (name == "state" && (query.state = job_state_of_name(value))) continue;
    if (name == "limit") {
      const auto [stop, status] = std::from_chars(value.data(), end, query.limit);
      if (status == std::errc() && stop == end && query.limit >= 1 && query.limit <= kMaxListed) {
        continue;
      }
    }
    return Error{ErrorCode::bad_request,
                 fmt::format("The list takes state=<a job state> and limit=1…{}.", kMaxListed)};
  }
  return query;
}

}  // namespace

HttpResponse Api::list_jobs(const HttpRequest& request) {
  const auto query = job_query(request);
  if (!query) return refuse(query.error());
  const auto jobs = jobs_.list(*query);
  if (!jobs) return refuse(jobs.error());
  Json documents = Json::array();
  for (const Job& job : *jobs) documents.push_back(document_of(job));
  return json_response(Json{{"jobs", std::move(documents)}});
}

HttpResponse Api::cancel_job(const std::string& id) {
  const auto job = cancel(id);
  return job ? job_response(*job, 200) : refuse(job.error());
}

HttpResponse Api::delete_job(const std::string& id) {
  const auto ended = cancel(id);
  if (!ended) return refuse(ended.error());
  const auto job = jobs_.expire(id);
  if (!job) return refuse(job.error());
  if (ended->result) {
    if (auto removed = blobs_.remove(ended->result->key); !removed) {
      about(log_, *ended)
          .write(LogLevel::warning, "result_not_removed", {{"reason", removed.error().message}});
    }
  }
  board_.announce();
  return job_response(*job, 200);
}

Result<Job> Api::cancel(const std::string& id) {
  const auto before = jobs_.find(id);
  auto job = jobs_.cancel(id);
  if (!job || job->state != JobState::canceled) return job;
  if (before && !is_final(before->state)) {
    const UnixMillis end = job->finished.value_or(job->created);
    metrics_.job_ended(problem_kind(ErrorCode::canceled).slug,
                       std::chrono::milliseconds(end - job->created));
  }
  supervisor_.interrupt(id);
  if (auto removed = blobs_.remove(job->input.key); !removed) {
    about(log_, *job)
        .write(LogLevel::warning, "input_not_removed", {{"reason", removed.error().message}});
  }
  about(log_, *job).write(LogLevel::info, "job_canceled");
  board_.announce();
  return job;
}

Json Api::document_of(const Job& job) const {
  JobFacts facts;
  facts.id = job.id;
  facts.state = job.state;
  facts.revision = job.revision;
  facts.attempt = job.attempt;
  facts.created = job.created;
  facts.started = job.started;
  facts.finished = job.finished;
  facts.input = {job.input_format, job.input.bytes, job.input.sha256, job.input_files};
  // Both documents were written by this program; one that cannot be read back is shown as null.
  if (auto parameters = parse_json(job.parameters)) facts.parameters = std::move(*parameters);
  if (!job.report.empty()) {
    if (auto report = parse_json(job.report)) facts.report = std::move(*report);
  }
  facts.progress = board_.progress(job.id);
  facts.problem = job.problem;
  if (job.result) facts.result = {job.result_format, job.result->bytes, job.result->sha256};
  return job_document(facts);
}

HttpResponse Api::job_response(const Job& job, int status) const {
  HttpResponse response = json_response(document_of(job), status);
  add_version(response, job);
  if (status == 202) response.headers.emplace_back("Location", "/v1/jobs/" + job.id);
  return response;
}

}  // namespace fairway
