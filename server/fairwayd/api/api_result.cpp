// The result of a job, or why there is none.

#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/result_format.h"
#include "server/fairwayd/http/file_answer.h"
#include "server/fairwayd/http/http_accept.h"

namespace fairway {
namespace {

/// How long the job waited and ran, and was in each stage where this server ran it.
std::string server_timing(const Job& job, const StageTimes& stages) {
  const UnixMillis started = job.started.value_or(job.created);
  const UnixMillis finished = job.finished.value_or(started);
  std::string text =
      fmt::format("queue;dur={}, run;dur={}", started - job.created, finished - started);
  for (const auto& [stage, time] : stages) {
    text += fmt::format(", {};dur={}", stage, static_cast<double>(time.count()) / 1000.0);
  }
  return text;
}

}  // namespace

HttpResponse Api::show_result(const HttpRequest& request, const JobName& name) {
  const auto job = jobs_.find(name);
  return job ? result_of(*job, request) : refuse(job.error());
}

HttpResponse Api::result_of(const Job& job, const HttpRequest& request) {
  if (job.state == JobState::failed) {
    return problem_response(
        job.problem.value_or(Error{ErrorCode::internal, "The job failed without a reason."}));
  }
  if (job.state == JobState::canceled) {
    return problem_response({ErrorCode::canceled, "The job was canceled and has no result."});
  }
  if (job.state == JobState::expired) {
    return problem_response({ErrorCode::gone, "The result is no longer kept: send the job again."});
  }
  if (!job.result) {
    HttpResponse response = problem_response(
        {ErrorCode::not_ready, "The job has no result yet: ask again when it has succeeded."});
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  const std::string media_type(media_type_of(job.result_format));
  if (accept_weight(request, media_type) == 0) return refuse(not_acceptable(job.result_format));
  auto file = blobs_.open(job.result->key);
  if (!file) return refuse(file.error());
  HttpResponse response = file_answer(request, std::move(*file),
                                      {job.result->bytes, job.result->sha256, media_type,
                                       fmt::format("{}.{}", job.id, name_of(job.result_format))});
  response.headers.emplace_back("Server-Timing", server_timing(job, board_.stages(job.number)));
  return response;
}

}  // namespace fairway
