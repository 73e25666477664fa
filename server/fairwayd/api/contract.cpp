#include "server/fairwayd/api/contract.h"

#include <string_view>

#include "proto/messages/method_catalog.h"
#include "proto/messages/openapi.h"

namespace fairway {

namespace {

HttpResponse json_text(std::string_view body) {
  HttpResponse response;
  response.content_type = "application/json";
  response.body = body;
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  return response;
}

}  // namespace

Contract::Contract()
    : openapi_(dump_json(openapi_document()) + "\n"),
      methods_(dump_json(methods_document()) + "\n") {}

HttpResponse Contract::answer(Place place) const {
  switch (place) {
    case Place::openapi:
      return json_text(openapi_);
    case Place::methods:
      return json_text(methods_);
    default:
      return problem_response({ErrorCode::not_found, "There is nothing at this path."});
  }
}

}  // namespace fairway
