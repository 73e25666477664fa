#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/fairwayd/store/access.h"

namespace fairway {

/// The places of the API. Their paths and methods stand in one table, in routes.cpp.
enum class Place {
  livez,           ///< /livez
  readyz,          ///< /readyz
  metrics,         ///< /metrics
  jobs,            ///< /v1/jobs
  job,             ///< /v1/jobs/{id}
  job_result,      ///< /v1/jobs/{id}/result
  job_events,      ///< /v1/jobs/{id}/events
  job_cancel,      ///< /v1/jobs/{id}/cancel
  job_retry,       ///< /v1/jobs/{id}/retry
  job_deliveries,  ///< /v1/jobs/{id}/deliveries
  job_redeliver,   ///< /v1/jobs/{id}/deliveries/{delivery}/redeliver
  denoise,         ///< /v1/denoise
  inspect,         ///< /v1/inspect
  uploads,         ///< /v1/uploads
  upload,          ///< /v1/uploads/{id}
  methods,         ///< /v1/methods
  openapi,         ///< /openapi.json
  page,            ///< /
  page_file,       ///< /assets/{file}
  sample,          ///< /samples/{file}
  docs,            ///< /docs
  docs_file,       ///< /docs/{file}
};

struct Route {
  Place place = Place::livez;
  std::string id = {};        ///< what stands for {id} or {file}
  std::string delivery = {};  ///< the same of {delivery}
};

/// The place of a decoded path; nothing where there is none, or where {id} or {delivery}
/// cannot be an id, or {file} not the name of a file.
std::optional<Route> route_of(std::string_view path);

/// Which listener a request came to.
enum class Entrance {
  only,   ///< the one listener there is
  main,   ///< the main one, beside one for administration
  admin,  ///< the one for administration
};

/// True where the place may be reached there: health everywhere, the API at the main listener,
/// metrics at the one for administration if there is one.
bool is_open(Place place, Entrance entrance);

/// The path of a place as the table has it: "/v1/jobs/{id}".
std::string_view pattern_of(Place place);

/// The methods of a place: "GET, HEAD, POST".
std::string_view allowed_methods(Place place);

/// The same as an Allow header has them: with OPTIONS, which every place is asked with.
std::string allow_header(Place place);

/// True where the method is one of them.
bool is_allowed(Place place, std::string_view method);

/// What a key must allow for such a request; nothing where anybody may ask.
std::optional<Scope> needed_scope(Place place, std::string_view method);

/// True where the place wants the body of such a request.
bool takes_body(Place place, std::string_view method);

/// True for the pages and what they load.
bool is_site(Place place);

/// True where the body is work: what is limited, and tells its limits.
bool is_submit(Place place, std::string_view method);

/// A path with {id} as it stands in the table, and its methods.
struct RoutePattern {
  std::string_view path;
  std::string_view methods;
};

/// Of every place one.
std::vector<RoutePattern> route_patterns();

}  // namespace fairway
