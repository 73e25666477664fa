#pragma once

#include "proto/messages/json.h"

namespace fairway {

/// The contract of the HTTP API as it is served: proto/openapi.yaml, with parameter_schema() as its
/// schema Parameters. OpenAPI 3.1.
Json openapi_document();

}  // namespace fairway
