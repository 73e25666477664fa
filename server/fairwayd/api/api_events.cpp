// GET /v1/jobs/{id}/events: a job's states and progress as they come.

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/job_events.h"
#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

/// The revision that a client saw last. Errors: bad_request.
Result<std::optional<std::int64_t>> last_event(const HttpRequest& request) {
  const auto text = trim_blanks(request.header("last-event-id").value_or(""));
  if (text.empty()) return std::optional<std::int64_t>();
  const auto number = digits_value(text);
  if (!number || *number > INT64_MAX) {
    return Error{ErrorCode::bad_request, "Last-Event-ID is the id of an event, a number."};
  }
  return std::optional(static_cast<std::int64_t>(*number));
}

/// An answer without content ends the reconnecting of a client that has seen all there is.
HttpResponse no_more_events() {
  constexpr int kNoContent = 204;
  HttpResponse response;
  response.status = kNoContent;
  return response;
}

}  // namespace

HttpResponse Api::job_events(const HttpRequest& request, const JobName& name) {
  const auto seen = last_event(request);
  if (!seen) return refuse(seen.error());
  const auto job = jobs_.find(name);
  if (!job) return refuse(job.error());
  if (is_final(job->state) && *seen == job->revision) return no_more_events();
  const auto place = watches_.take();
  if (!place) {
    return refuse({ErrorCode::unavailable, "Too many clients follow jobs: ask for the document."});
  }
  const auto document = [this](const Job& followed) { return document_of(followed); };
  const auto events = std::make_shared<JobEvents>(
      JobWatch{jobs_, board_, stop_, request.client_is_there}, document, *seen);
  HttpResponse response;
  response.content_type = kEventStreamType;
  response.headers.emplace_back("Cache-Control", "no-store");
  response.headers.emplace_back("X-Accel-Buffering", "no");  // nginx would hold events back
  response.stream = [events, number = job->number, place](const BodySink& sink) {
    events->send(number, sink);
  };
  return response;
}

}  // namespace fairway
