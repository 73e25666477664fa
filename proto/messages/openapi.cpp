#include "proto/messages/openapi.h"

#include <string_view>

#include "proto/messages/parameter_schema.h"

namespace fairway {

extern const std::string_view kOpenApi;  ///< proto/openapi.yaml as JSON, made by the build

Json openapi_document() {
  // The build has made this text with a JSON library: it parses.
  Json document = Json::parse(kOpenApi);
  document["components"]["schemas"]["Parameters"] = parameter_schema();
  return document;
}

}  // namespace fairway
