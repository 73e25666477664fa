#include "server/fairwayd/api/routes.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "server/fairwayd/store/job_id.h"

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
    Row{Place::job_deliveries, "/v1/jobs/{id}/deliveries", "GET, HEAD"},
    Row{Place::job_redeliver, "/v1/jobs/{id}/deliveries/{delivery}/redeliver", "POST"},
    Row{Place::denoise, "/v1/denoise", "POST", "POST"},
    Row{Place::inspect, "/v1/inspect", "POST", "POST"},
    Row{Place::uploads, "/v1/uploads", "POST", "POST"},
    Row{Place::upload, "/v1/uploads/{id}", "HEAD, PATCH, DELETE", "PATCH"},
    Row{Place::methods, "/v1/methods", "GET, HEAD"},
    Row{Place::openapi, "/openapi.json", "GET, HEAD"},
    Row{Place::page, "/", "GET, HEAD"},
    Row{Place::page_file, "/assets/{file}", "GET, HEAD"},
    Row{Place::sample, "/samples/{file}", "GET, HEAD"},
    Row{Place::docs, "/docs", "GET, HEAD"},
    Row{Place::docs_file, "/docs/{file}", "GET, HEAD"},
};

/// True for a name without folders.
bool is_file_name(std::string_view name) {
  constexpr std::size_t kLongest = 100;
  return !name.empty() && name.size() <= kLongest && !name.starts_with('.') &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '.' || c == '-' || c == '_';
         });
}

/// What `path` has where the pattern says {…}, in order.
std::optional<std::vector<std::string>> match(std::string_view pattern, std::string_view path) {
  std::vector<std::string> ids;
  for (std::size_t at = pattern.find('{'); at != std::string_view::npos; at = pattern.find('{')) {
    if (!path.starts_with(pattern.substr(0, at))) return std::nullopt;
    path.remove_prefix(at);
    const std::string_view id = path.substr(0, path.find('/'));
    const bool fits = pattern.substr(at).starts_with("{file}") ? is_file_name(id) : is_job_id(id);
    if (!fits) return std::nullopt;
    ids.emplace_back(id);
    path.remove_prefix(id.size());
    pattern.remove_prefix(pattern.find('}') + 1);
  }
  return pattern == path ? std::optional(std::move(ids)) : std::nullopt;
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
    auto ids = match(row.path, path);
    if (!ids) continue;
    ids->resize(2);
    return Route{row.place, std::move(ids->at(0)), std::move(ids->at(1))};
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

std::string allow_header(Place place) {
  return std::string(allowed_methods(place)) + ", OPTIONS";
}

bool is_allowed(Place place, std::string_view method) {
  return lists(allowed_methods(place), method);
}

bool is_site(Place place) {
  switch (place) {
    case Place::page:
    case Place::page_file:
    case Place::sample:
    case Place::docs:
    case Place::docs_file:
      return true;
    default:
      return false;
  }
}

std::optional<Scope> needed_scope(Place place, std::string_view method) {
  if (is_site(place)) return std::nullopt;
  switch (place) {
    case Place::livez:
    case Place::readyz:
    case Place::methods:
    case Place::openapi:
      return std::nullopt;
    case Place::metrics:
      return Scope::admin;
    case Place::upload:  // who uploads asks how far he is
      return Scope::submit;
    default:
      break;
  }
  return method == "GET" || method == "HEAD" ? Scope::read : Scope::submit;
}

bool takes_body(Place place, std::string_view method) {
  return lists(row_of(place).body_methods, method);
}

bool is_submit(Place place, std::string_view method) {
  return place != Place::uploads && place != Place::upload && takes_body(place, method);
}

std::vector<RoutePattern> route_patterns() {
  std::vector<RoutePattern> patterns;
  patterns.reserve(kRows.size());
  for (const Row& row : kRows) patterns.push_back({row.path, row.methods});
  return patterns;
}

}  // namespace fairway
