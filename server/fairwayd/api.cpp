// Which request goes where, and how errors are told.

#include "server/fairwayd/api.h"

#include <utility>

#include <fmt/format.h>

namespace fairway {
namespace {

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

}  // namespace

Api::Api(JobStore& jobs, BlobStore& blobs, JobBoard& board, Supervisor& supervisor,
         ServiceMetrics& metrics, const Log& log, const ApiOptions& options, std::stop_token stop)
    : jobs_(jobs),
      blobs_(blobs),
      board_(board),
      supervisor_(supervisor),
      metrics_(metrics),
      log_(log),
      options_(options),
      stop_(std::move(stop)) {}

bool Api::wants_body(const HttpRequest& request) const {
  const auto route = route_of(request.path);
  return route && takes_body(route->place, request.method);
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
    case Place::readyz:
    case Place::metrics:
      break;  // answered by Operations, in front of this
    case Place::jobs:
      return request.method == "POST" ? submit_job(request, body) : list_jobs(request);
    case Place::job:
      if (request.method == "PUT") return put_job(route.id, request, body);
      return request.method == "DELETE" ? delete_job({.id = route.id})
                                        : show_job(request, {.id = route.id});
    case Place::job_result:
      return show_result(request, {.id = route.id});
    case Place::job_events:
      return job_events(request, {.id = route.id});
    case Place::job_cancel:
      return cancel_job({.id = route.id});
    case Place::job_retry:
      return retry_job({.id = route.id});
    case Place::denoise:
      return denoise(request, body);
    case Place::inspect:
      return inspect(request, body);
  }
  return problem_response({ErrorCode::internal, "A place without an answer."});
}

HttpResponse Api::refuse(const Error& error) const {
  HttpResponse response = problem_response(public_error(error));
  if (response.status >= 500) response.cause = error.message;
  return response;
}

/// A refused upload is not read on: its connection ends.
HttpResponse Api::refuse_upload(const Error& error) const {
  HttpResponse response = refuse(error);
  response.close = true;
  return response;
}

}  // namespace fairway
