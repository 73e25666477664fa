#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace fairway {

/// The places of the API.
enum class Place {
  livez,       ///< /livez
  jobs,        ///< /v1/jobs
  job,         ///< /v1/jobs/{id}
  job_result,  ///< /v1/jobs/{id}/result
  job_cancel,  ///< /v1/jobs/{id}/cancel
  denoise,     ///< /v1/denoise
  inspect,     ///< /v1/inspect
};

struct Route {
  Place place = Place::livez;
  std::string job_id;  ///< of the shape of an id, for the places of one job
};

/// The place of a decoded path; nothing where there is none, or where {id} cannot be an id.
std::optional<Route> route_of(std::string_view path);

/// The methods of a place, as in an Allow header: "GET, HEAD, POST".
std::string_view allowed_methods(Place place);

/// True where the method is one of them.
bool is_allowed(Place place, std::string_view method);

}  // namespace fairway
