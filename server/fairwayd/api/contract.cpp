#include "server/fairwayd/api/contract.h"

#include <string_view>

#include "proto/messages/method_catalog.h"
#include "proto/messages/openapi.h"

namespace fairway {

// The files of server/fairwayd/docs, made into sources by the build.
extern const std::string_view kDocsPage;
extern const std::string_view kDocsScript;
extern const std::string_view kDocsStyle;

namespace {

constexpr const char* kJson = "application/json";

HttpResponse text_response(std::string_view body, const char* type) {
  HttpResponse response;
  response.content_type = type;
  response.body = body;
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  return response;
}

/// The page saves answers through blob: links, which need no permission of their own.
HttpResponse page() {
  HttpResponse response = text_response(kDocsPage, "text/html; charset=utf-8");
  response.headers.emplace_back("Content-Security-Policy",
                                "default-src 'self'; base-uri 'none'; frame-ancestors 'none'");
  return response;
}

}  // namespace

Contract::Contract()
    : openapi_(dump_json(openapi_document()) + "\n"),
      methods_(dump_json(methods_document()) + "\n") {}

HttpResponse Contract::answer(Place place) const {
  switch (place) {
    case Place::openapi:
      return text_response(openapi_, kJson);
    case Place::methods:
      return text_response(methods_, kJson);
    case Place::docs:
      return page();
    case Place::docs_code:
      return text_response(kDocsScript, "text/javascript; charset=utf-8");
    case Place::docs_style:
      return text_response(kDocsStyle, "text/css; charset=utf-8");
    default:
      return problem_response({ErrorCode::not_found, "There is nothing at this path."});
  }
}

}  // namespace fairway
