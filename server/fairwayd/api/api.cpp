// Which request goes where, and how errors are told.

#include "server/fairwayd/api/api.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/api/tus.h"
#include "server/fairwayd/site/site.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

/// An error as a client may see it: what the system says about files and paths stays in the log.
Error public_error(const Error& error) {
  switch (error.code) {
    case ErrorCode::storage_full:
      return {error.code, "The server's storage is full: try again later."};
    case ErrorCode::io:
      return {ErrorCode::unavailable,
              "The server could not read or write its storage: try again later."};
    case ErrorCode::internal:
      return {error.code, "The server met a defect of its own."};
    default:
      return error;
  }
}

}  // namespace

Api::Api(JobStore& jobs, BlobStore& blobs, ResumableUploads& uploads, Outbox& outbox,
         JobBoard& board, Supervisor& supervisor, ServiceMetrics& metrics, const Gate& gate,
         const Log& log, const ApiOptions& options, std::stop_token stop)
    : jobs_(jobs),
      blobs_(blobs),
      uploads_(uploads),
      outbox_(outbox),
      board_(board),
      supervisor_(supervisor),
      metrics_(metrics),
      gate_(gate),
      log_(log),
      options_(options),
      stop_(std::move(stop)),
      rate_limit_(options.rate) {}

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
    const std::string allowed = allow_header(route->place);
    HttpResponse response = problem_response(
        {ErrorCode::method_not_allowed, fmt::format("This path takes {} only.", allowed)});
    response.headers.emplace_back("Allow", allowed);
    return response;
  }
  std::string tenant;
  if (const auto scope = needed_scope(route->place, request.method)) {
    auto caller = gate_.admit(request, *scope);
    if (!caller) return refuse(caller.error());
    tenant = std::move(caller->tenant);
  }
  return is_submit(route->place, request.method) ? answer_in_limits(*route, tenant, request, body)
                                                 : answer_place(*route, tenant, request, body);
}

/// Those that submit are told how much more they may.
HttpResponse Api::answer_in_limits(const Route& route, const std::string& tenant,
                                   const HttpRequest& request, BodySource& body) {
  const RateLimit::Verdict verdict = rate_limit_.take(tenant);
  HttpResponse response =
      verdict.allowed
          ? answer_place(route, tenant, request, body)
          : refuse({ErrorCode::rate_limited,
                    fmt::format("More than {} submits came in a minute: try again in {} s.",
                                rate_limit_.per_minute(), verdict.reset.count())});
  std::string policy = fmt::format("\"queue\";q={}", options_.queue_limit);
  std::string left;
  if (const auto queued = jobs_.queue_length()) {
    left = fmt::format("\"queue\";r={}",
                       options_.queue_limit - std::min(*queued, options_.queue_limit));
  }
  if (rate_limit_.is_on()) {
    policy += fmt::format(", \"submits\";q={};w=60", rate_limit_.per_minute());
    left += fmt::format("{}\"submits\";r={};t={}", left.empty() ? "" : ", ", verdict.left,
                        verdict.reset.count());
  }
  response.headers.emplace_back("RateLimit-Policy", policy);
  if (!left.empty()) response.headers.emplace_back("RateLimit", left);
  if (!verdict.allowed) {
    response.headers.emplace_back("Retry-After", fmt::to_string(verdict.reset.count()));
  }
  return response;
}

HttpResponse Api::answer_place(const Route& route, const std::string& tenant,
                               const HttpRequest& request, BodySource& body) {
  switch (route.place) {
    case Place::jobs:
      return request.method == "POST" ? submit_job({tenant, random_id()}, request, body)
                                      : list_jobs(tenant, request);
    case Place::denoise:
      return denoise(tenant, request, body);
    case Place::inspect:
      return inspect(request, body);
    case Place::uploads:
    case Place::upload:
      return answer_upload(route, tenant, request, body);
    case Place::methods:
    case Place::openapi:
      return contract_.answer(route.place);
    default:
      if (is_site(route.place)) return site_answer(request);
      return answer_job(route, {tenant, route.id}, request, body);
  }
}

HttpResponse Api::answer_job(const Route& route, const JobName& name, const HttpRequest& request,
                             BodySource& body) {
  switch (route.place) {
    case Place::job:
      if (request.method == "PUT") return submit_job(name, request, body);
      return request.method == "DELETE" ? delete_job(name) : show_job(request, name);
    case Place::job_result:
      return show_result(request, name);
    case Place::job_events:
      return job_events(request, name);
    case Place::job_cancel:
      return cancel_job(name);
    case Place::job_retry:
      return retry_job(name);
    case Place::job_deliveries:
      return list_deliveries(name);
    case Place::job_redeliver:
      return redeliver(name, route.delivery);
    default:
      break;  // answered by Operations, in front of this
  }
  return problem_response({ErrorCode::internal, "A place without an answer."});
}

HttpResponse Api::answer_upload(const Route& route, const std::string& tenant,
                                const HttpRequest& request, BodySource& body) {
  auto answer = answer_tus(uploads_, route, tenant, request, body);
  return answer ? *std::move(answer) : refuse(answer.error());
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
