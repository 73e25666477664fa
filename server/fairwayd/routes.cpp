#include "server/fairwayd/routes.h"

#include "server/os/random_id.h"

namespace fairway {

std::optional<Route> route_of(std::string_view path) {
  constexpr std::string_view kJobs = "/v1/jobs";
  if (path == "/livez") return Route{Place::livez, {}};
  if (path == "/v1/denoise") return Route{Place::denoise, {}};
  if (path == "/v1/inspect") return Route{Place::inspect, {}};
  if (path == kJobs) return Route{Place::jobs, {}};
  if (!path.starts_with(kJobs) || path.at(kJobs.size()) != '/') return std::nullopt;
  const std::string_view rest = path.substr(kJobs.size() + 1);
  const std::string_view id = rest.substr(0, rest.find('/'));
  if (!is_random_id(id)) return std::nullopt;
  const std::string_view tail = rest.substr(id.size());
  if (tail.empty()) return Route{Place::job, std::string(id)};
  if (tail == "/result") return Route{Place::job_result, std::string(id)};
  if (tail == "/cancel") return Route{Place::job_cancel, std::string(id)};
  return std::nullopt;
}

std::string_view allowed_methods(Place place) {
  switch (place) {
    case Place::livez:
    case Place::job_result:
      return "GET, HEAD";
    case Place::jobs:
      return "GET, HEAD, POST";
    case Place::job:
      return "GET, HEAD, DELETE";
    case Place::job_cancel:
    case Place::denoise:
    case Place::inspect:
      return "POST";
  }
  return "";
}

bool is_allowed(Place place, std::string_view method) {
  std::string_view rest = allowed_methods(place);
  while (!rest.empty()) {
    const std::size_t comma = rest.find(", ");
    if (rest.substr(0, comma) == method) return true;
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 2);
  }
  return false;
}

}  // namespace fairway
