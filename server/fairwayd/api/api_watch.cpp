// GET /v1/jobs/{id}: the job document, at once or when it changes.

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/job_version.h"
#include "server/fairwayd/http/http_prefer.h"
#include "server/fairwayd/work/job_wait.h"

namespace fairway {
namespace {

constexpr std::chrono::seconds kLongestWait{60};

/// Waiting is only for a client that says what it knows.
Preferences heeded_preferences(const HttpRequest& request) {
  Preferences heeded;
  if (!request.header("if-none-match")) return heeded;
  heeded.wait = preferences_of(request).wait;
  if (heeded.wait) heeded.wait = std::min(*heeded.wait, kLongestWait);
  return heeded;
}

/// The answer to a client that knows the job's revision.
HttpResponse unchanged(const Job& job) {
  constexpr int kNotModified = 304;
  HttpResponse response;
  response.status = kNotModified;
  add_version(response, job);
  return response;
}

}  // namespace

HttpResponse Api::show_job(const HttpRequest& request, const JobName& name) {
  const auto job = jobs_.find(name);
  if (!job) return refuse(job.error());
  switch (evaluate_conditions(request, version_of(*job))) {
    case Condition::proceed:
      return changed(*job, request);
    case Condition::not_modified:
      return await_change(request, *job);
    case Condition::failed:
      break;
  }
  return refuse({ErrorCode::precondition_failed,
                 "If-Match never fits a job document, whose ETag is weak: leave it out."});
}

HttpResponse Api::changed(const Job& job, const HttpRequest& request) {
  HttpResponse response = job_response(job, 200);
  const Preferences heeded = heeded_preferences(request);
  if (heeded.wait) response.headers.emplace_back("Preference-Applied", applied_text(heeded));
  return response;
}

/// A long poll, where the client prefers to wait and there is room for those who do.
HttpResponse Api::await_change(const HttpRequest& request, const Job& known) {
  const Preferences heeded = heeded_preferences(request);
  const auto place = heeded.wait ? watches_.take() : nullptr;
  if (!place) return unchanged(known);
  const auto waited =
      wait_for_job({jobs_, board_, stop_, request.client_is_there}, known.number,
                   std::chrono::steady_clock::now() + *heeded.wait,
                   [&](const Job& job) { return !knows_version(request, version_of(job)); });
  if (!waited) return refuse(waited.error());
  if (waited->end == WaitEnd::reached) return changed(waited->job, request);
  HttpResponse response = unchanged(waited->job);
  response.headers.emplace_back("Preference-Applied", applied_text(heeded));
  response.close = waited->end != WaitEnd::time_up;
  return response;
}

}  // namespace fairway
