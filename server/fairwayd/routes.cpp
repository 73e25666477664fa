#include "server/fairwayd/routes.h"

#include <algorithm>
#include <array>

#include "server/fairwayd/job_id.h"

namespace fairway {
namespace {

struct Row {
  Place place;
  std::string_view path;
  std::string_view methods;
  std::string_view body_methods = {};  ///< those of them with a body
};

constexpr std::array kRows = {
    Row{Place::livez, "/livez", "GET, HEAD"},
    Row{Place::readyz, "/readyz", "GET, HEAD"},
    Row{Place::metrics, "/metrics", "GET, HEAD"},
    Row{Place::jobs, "/v1/jobs", "GET, HEAD, POST", "POST"},
    Row{Place::job, "/v1/jobs/{id}", "GET, HEAD, PUT, DELETE", "PUT"},
    Row{Place::job_result, "/v1/jobs/{id}/result", "GET, HEAD"},
    Row{Place::job_events, "/v1/jobs/{id}/events", "GET, HEAD"},
    Row{Place::job_cancel, "/v1/jobs/{id}/cancel", "POST"},
    Row{Place::job_retry, "/v1/jobs/{id}/retry", "POST"},
    Row{Place::denoise, "/v1/denoise", "POST", "POST"},
    Row{Place::inspect, "/v1/inspect", "POST", "POST"},
};

constexpr std::string_view kId = "{id}";

/// The id that `path` has where the pattern says {id}; "" where that says nothing.
std::optional<std::string> match(std::string_view pattern, std::string_view path) {
  const std::size_t at = pattern.find(kId);
  if (at == std::string_view::npos) {
    return pattern == path ? std::optional(std::string()) : std::nullopt;
  }
  if (!path.starts_with(pattern.substr(0, at))) return std::nullopt;
  path.remove_prefix(at);
  const std::string_view id = path.substr(0, path.find('/'));
  if (!is_job_id(id) || path.substr(id.size()) != pattern.substr(at + kId.size())) {
    return std::nullopt;
  }
  return std::string(id);
}

const Row& row_of(Place place) {
  return *std::find_if(kRows.begin(), kRows.end(),
                       [place](const Row& row) { return row.place == place; });
}

bool lists(std::string_view methods, std::string_view method) {
  while (!methods.empty()) {
    const std::size_t comma = methods.find(", ");
    if (methods.substr(0, comma) == method) return true;
    methods = comma == std::string_view::npos ? std::string_view() : methods.substr(comma + 2);
  }
  return false;
}

}  // namespace

std::optional<Route> route_of(std::string_view path) {
  for (const Row& row : kRows) {
    if (auto id = match(row.path, path)) return Route{row.place, *std::move(id)};
  }
  return std::nullopt;
}

bool is_open(Place place, Entrance entrance) {
  if (entrance == Entrance::only || place == Place::livez || place == Place::readyz) return true;
  return (place == Place::metrics) == (entrance == Entrance::admin);
}

std::string_view pattern_of(Place place) {
  return row_of(place).path;
}

std::string_view allowed_methods(Place place) {
  return row_of(place).methods;
}

bool is_allowed(Place place, std::string_view method) {
  return lists(allowed_methods(place), method);
}

std::optional<Scope> needed_scope(Place place, std::string_view method) {
  if (place == Place::livez || place == Place::readyz) return std::nullopt;
  if (place == Place::metrics) return Scope::admin;
  return method == "GET" || method == "HEAD" ? Scope::read : Scope::submit;
}

bool takes_body(Place place, std::string_view method) {
  return lists(row_of(place).body_methods, method);
}

}  // namespace fairway
