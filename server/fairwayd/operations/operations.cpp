#include "server/fairwayd/operations/operations.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/fairwayd/api/tus.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

/// An answer about now.
HttpResponse uncached(HttpResponse response) {
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

template <class T>
std::optional<T> value_of(Result<T> result) {
  return result ? std::optional<T>(*std::move(result)) : std::nullopt;
}

}  // namespace

bool Operations::wants_body(const HttpRequest& request) const {
  const auto route = route_of(request.path);
  return route && is_open(route->place, entrance_) &&
         parts_.api.wants_body(with_tus_method(request));
}

HttpResponse Operations::answer(const HttpRequest& sent, BodySource& body) {
  const HttpRequest request = with_tus_method(sent);
  HttpResponse response = choose(request, body);
  if (const auto route = route_of(request.path); route && is_tus(route->place)) {
    response.headers.emplace_back("Tus-Resumable", kTusVersion);
  }
  parts_.cross_origin.mark(request, response);
  if (!response.cause.empty()) {
    parts_.log.write(LogLevel::error, "request_failed",
                     {{"reason", response.cause}, {"trace", request.trace.trace_id}});
  }
  return response;
}

bool Operations::is_vital(std::string_view method, std::string_view path) const {
  const auto route = route_of(path);
  return (method == "GET" || method == "HEAD") && route &&
         (route->place == Place::livez || route->place == Place::readyz);
}

HttpResponse Operations::choose(const HttpRequest& request, BodySource& body) {
  const auto route = route_of(request.path);
  if (route && !is_open(route->place, entrance_)) {
    return problem_response({ErrorCode::not_found, "There is nothing at this path here."});
  }
  if (route && request.method == "OPTIONS") {
    HttpResponse response = parts_.cross_origin.options(request, route->place);
    if (is_tus(route->place)) {
      response.headers.insert(response.headers.end(), parts_.tus.begin(), parts_.tus.end());
    }
    return response;
  }
  if (auto allowed = parts_.cross_origin.check(request); !allowed) {
    return problem_response(allowed.error());
  }
  if (route && is_allowed(route->place, request.method)) {
    if (route->place == Place::livez) return uncached(json_response(Json{{"status", "alive"}}));
    if (route->place == Place::readyz) return uncached(show_readiness(request));
    if (route->place == Place::metrics) return uncached(show_metrics(request));
  }
  return parts_.api.answer(request, body);
}

HttpResponse Operations::show_readiness(const HttpRequest& request) {
  const bool canary = request.query == NameValues{{"canary", "1"}};
  if (!canary && !request.query.empty()) {
    return problem_response({ErrorCode::bad_request, "The query takes canary=1 only."});
  }
  bool ready = true;
  Json checks = Json::object();
  for (const ReadinessCheck& check : parts_.readiness.check(canary)) {
    ready = ready && check.ok;
    Json& entry = checks[std::string(check.name)] = Json{{"ok", check.ok}};
    if (!check.ok) entry["detail"] = check.detail;
  }
  const Json document{{"status", ready ? "ready" : "not_ready"}, {"checks", std::move(checks)}};
  return json_response(document, ready ? 200 : 503);
}

HttpResponse Operations::show_metrics(const HttpRequest& request) {
  if (const auto caller = parts_.gate.admit(request, Scope::admin); !caller) {
    return problem_response(caller.error());
  }
  HttpResponse response;
  response.content_type = kMetricsMediaType;
  response.body =
      parts_.metrics.text(value_of(parts_.jobs.counts()), wall_clock(),
                          value_of(parts_.blobs.free_bytes()), value_of(parts_.outbox.counts()));
  return response;
}

void Operations::answered(const HttpExchange& exchange) {
  const auto route = route_of(exchange.path);
  const std::string_view pattern = route ? pattern_of(route->place) : "none";
  parts_.metrics.answered(exchange, pattern);
  parts_.log.write(LogLevel::info, "http",
                   {{"method", exchange.method},
                    {"route", pattern},
                    {"status", exchange.status},
                    {"bytes", exchange.bytes_out},
                    {"ms", static_cast<double>(exchange.took.count()) / 1000.0},
                    {"trace", exchange.trace.trace_id}});
}

void Operations::connections_changed(int by) {
  parts_.metrics.connections_changed(by);
}

}  // namespace fairway
