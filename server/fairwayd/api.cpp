#include "server/fairwayd/api.h"

#include <charconv>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/upload.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxListed = 200;
/// How often a waiting request looks whether its client is still there.
constexpr std::chrono::milliseconds kLookForClient{200};

/// An error as a client may see it: what the system says about files and paths stays in the log.
Error public_error(const Error& error) {
  switch (error.code) {
    case ErrorCode::storage_full:
      return {error.code, "The server's storage is full: try again later."};
    case ErrorCode::io:
      return {error.code, "The server could not read or write its storage: try again later."};
    case ErrorCode::internal:
      return {error.code, "The server met a defect of its own."};
    default:
      return error;
  }
}

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

Api::Api(JobStore& jobs, BlobStore& blobs, JobBoard& board, Supervisor& supervisor, const Log& log,
         const ApiOptions& options, std::stop_token stop)
    : jobs_(jobs),
      blobs_(blobs),
      board_(board),
      supervisor_(supervisor),
      log_(log),
      options_(options),
      stop_(std::move(stop)) {}

std::vector<std::string> Api::upload_paths() const {
  return {"/v1/jobs", "/v1/denoise", "/v1/inspect"};
}

bool Api::is_upload(const HttpRequest& request) const {
  const auto route = route_of(request.path);
  return route && request.method == "POST" &&
         (route->place == Place::jobs || route->place == Place::denoise ||
          route->place == Place::inspect);
}

HttpResponse Api::answer(const HttpRequest& request, BodySource& body) {
  const auto route = route_of(request.path);
  if (!route) {
    return problem_response({ErrorCode::not_found, "There is nothing at this path."});
  }
  if (!is_allowed(route->place, request.method)) {
    const std::string allowed(allowed_methods(route->place));
    HttpResponse response = problem_response(
        {ErrorCode::method_not_allowed, fmt::format("This path takes {} only.", allowed)});
    response.headers.emplace_back("Allow", allowed);
    return response;
  }
  return answer_place(*route, request, body);
}

HttpResponse Api::answer_place(const Route& route, const HttpRequest& request, BodySource& body) {
  switch (route.place) {
    case Place::livez:
      return json_response(Json{{"status", "alive"}});
    case Place::jobs:
      return request.method == "POST" ? submit_job(request, body) : list_jobs(request);
    case Place::job:
      return request.method == "DELETE" ? delete_job(route.job_id) : show_job(route.job_id);
    case Place::job_result:
      return show_result(route.job_id);
    case Place::job_cancel:
      return cancel_job(route.job_id);
    case Place::denoise:
      return denoise(request, body);
    case Place::inspect:
      return inspect(request, body);
  }
  return problem_response({ErrorCode::internal, "A place without an answer."});
}

HttpResponse Api::refuse(const Error& error) const {
  HttpResponse response = problem_response(public_error(error));
  if (response.status >= 500) {
    log_.write(LogLevel::error, "request_failed", {{"reason", error.message}});
  }
  return response;
}

/// A refused upload is not read on: its connection ends.
HttpResponse Api::refuse_upload(const Error& error) const {
  HttpResponse response = refuse(error);
  response.close = true;
  return response;
}

HttpResponse Api::submit_job(const HttpRequest& request, BodySource& body) {
  const auto job = submit(request, body);
  return job ? job_response(*job, 202) : refuse_upload(job.error());
}

HttpResponse Api::denoise(const HttpRequest& request, BodySource& body) {
  const auto job = submit(request, body);
  return job ? wait_for_result(*job, request) : refuse_upload(job.error());
}

HttpResponse Api::list_jobs(const HttpRequest& request) {
  const auto query = job_query(request);
  if (!query) return refuse(query.error());
  const auto jobs = jobs_.list(*query);
  if (!jobs) return refuse(jobs.error());
  Json documents = Json::array();
  for (const Job& job : *jobs) documents.push_back(document_of(job));
  return json_response(Json{{"jobs", std::move(documents)}});
}

HttpResponse Api::show_job(const std::string& id) {
  const auto job = jobs_.find(id);
  return job ? job_response(*job, 200) : refuse(job.error());
}

HttpResponse Api::show_result(const std::string& id) {
  const auto job = jobs_.find(id);
  return job ? result_of(*job) : refuse(job.error());
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
      log_.write(LogLevel::warning, "result_not_removed",
                 {{"job", id}, {"reason", removed.error().message}});
    }
  }
  board_.announce();
  return job_response(*job, 200);
}

/// Jobs and inspections wait in one queue.
Result<void> Api::check_queue() {
  const auto queued = jobs_.queue_length();
  if (!queued) return queued.error();
  if (*queued + supervisor_.waiting_inspections() >= options_.queue_limit) {
    return Error{ErrorCode::queue_full, "The queue is full: try again later."};
  }
  return {};
}

/// Order is the promise of a 202: the input is durable, then the row is committed.
Result<Job> Api::submit(const HttpRequest& request, BodySource& body) {
  if (auto checked = check_upload(request, options_.max_mesh_bytes); !checked) {
    return checked.error();
  }
  if (auto room = check_queue(); !room) return room.error();
  auto upload = receive_upload(request, body, blobs_, options_.max_mesh_bytes);
  if (!upload) return upload.error();
  const std::string id = random_id();
  auto input = upload->mesh->commit("in-" + id);
  if (!input) return input.error();
  const NewJob job{id, *input, upload->format, dump_json(parameters_document(upload->parameters)),
                   upload->files};
  auto stored = jobs_.submit(job, options_.queue_limit);
  if (!stored) {
    [[maybe_unused]] const auto removed = blobs_.remove(input->key);  // else swept at the start
    return stored.error();
  }
  log_.write(LogLevel::info, "job_queued", {{"job", id}, {"bytes", input->bytes}});
  board_.announce();
  supervisor_.wake();
  return stored;
}

Result<Job> Api::cancel(const std::string& id) {
  auto job = jobs_.cancel(id);
  if (!job || job->state != JobState::canceled) return job;
  supervisor_.interrupt(id);
  if (auto removed = blobs_.remove(job->input.key); !removed) {
    log_.write(LogLevel::warning, "input_not_removed",
               {{"job", id}, {"reason", removed.error().message}});
  }
  log_.write(LogLevel::info, "job_canceled", {{"job", id}});
  board_.announce();
  return job;
}

HttpResponse Api::wait_for_result(const Job& submitted, const HttpRequest& request) {
  const std::string location = "/v1/jobs/" + submitted.id;
  while (true) {
    const std::uint64_t turn = board_.turn();
    const auto job = jobs_.find(submitted.id);
    HttpResponse response;
    if (!job) {
      response = refuse(job.error());
    } else if (is_final(job->state)) {
      response = result_of(*job);
    } else if (!request.client_is_there()) {
      // Where the cancel cannot be written the job runs to its end, as one without a waiting
      // client.
      [[maybe_unused]] const auto canceled = cancel(submitted.id);
      response = problem_response({ErrorCode::canceled, "The client hung up."});
      response.close = true;
    } else if (stop_.stop_requested()) {
      response = problem_response(
          {ErrorCode::unavailable, "The server is stopping; the job goes on when it is back."});
    } else {
      board_.wait(turn, kLookForClient, stop_);
      continue;
    }
    response.headers.emplace_back("Location", location);
    return response;
  }
}

HttpResponse Api::result_of(const Job& job) {
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
  auto file = blobs_.open(job.result->key);
  if (!file) return refuse(file.error());
  HttpResponse response;
  response.content_type = media_type_of(job.result_format);
  response.file = FileBody{std::move(*file), job.result->bytes};
  response.headers.emplace_back("ETag", '"' + job.result->sha256 + '"');
  response.headers.emplace_back(
      "Content-Disposition",
      fmt::format("attachment; filename=\"{}.{}\"", job.id, name_of(job.result_format)));
  return response;
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
  if (status == 202) response.headers.emplace_back("Location", "/v1/jobs/" + job.id);
  return response;
}

}  // namespace fairway
