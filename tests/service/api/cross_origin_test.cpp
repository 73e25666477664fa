// What pages of other sites may do.
#include "server/fairwayd/api/cross_origin.h"

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

HttpRequest request(const std::string& method, const std::string& origin,
                    const std::string& host = "mesh.example") {
  HttpRequest made;
  made.method = method;
  made.headers = {{"host", host}};
  if (!origin.empty()) made.headers.emplace_back("origin", origin);
  return made;
}

std::string header(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

CrossOrigin of(std::string_view text) {
  const auto origins = parse_origins(text);
  REQUIRE(origins);
  return CrossOrigin(*origins);
}

}  // namespace

TEST_CASE("a list of origins is read, and anything else refused") {
  CHECK(parse_origins("")->empty());
  CHECK(parse_origins("https://A.example, http://b.example:81")->at(0) == "https://a.example");
  for (const char* text : {"a.example", "https://", "https://a.example/", "ftp://a", "https://*"}) {
    CAPTURE(text);
    const auto origins = parse_origins(text);
    REQUIRE_FALSE(origins);
    CHECK(origins.error().code == ErrorCode::usage);
  }
}

TEST_CASE("a page of a strange site changes nothing here") {
  const CrossOrigin none = of("");
  CHECK_FALSE(none.check(request("POST", "https://evil.example")));
  CHECK(none.check(request("POST", "https://evil.example")).error().code == ErrorCode::forbidden);
  CHECK_FALSE(none.check(request("DELETE", "null")));
  CHECK(none.check(request("GET", "https://evil.example")));
  CHECK(none.check(request("POST", "")));
  CHECK(none.check(request("POST", "https://mesh.example")));
  CHECK(none.check(request("POST", "http://mesh.example:8080", "mesh.example:8080")));
  CHECK_FALSE(none.check(request("POST", "http://mesh.example:81", "mesh.example:8080")));
  CHECK(of("https://app.example").check(request("POST", "https://app.example")));
  CHECK_FALSE(of("https://app.example").check(request("POST", "http://app.example")));
  CHECK(of("*").check(request("POST", "https://evil.example")));
}

TEST_CASE("only an origin on the list may read answers") {
  const CrossOrigin some = of("https://app.example");
  HttpResponse mine;
  some.mark(request("GET", "https://app.example"), mine);
  CHECK(header(mine, "Access-Control-Allow-Origin") == "https://app.example");
  CHECK(header(mine, "Access-Control-Expose-Headers").find("ETag") != std::string::npos);
  CHECK(header(mine, "Vary") == "Origin");
  HttpResponse theirs;
  some.mark(request("GET", "https://evil.example"), theirs);
  CHECK(header(theirs, "Access-Control-Allow-Origin").empty());
  CHECK(header(theirs, "Vary") == "Origin");
  HttpResponse nobodys;
  of("").mark(request("GET", "https://app.example"), nobodys);
  CHECK(nobodys.headers.empty());
}

TEST_CASE("a preflight is told what it may send") {
  const CrossOrigin some = of("https://app.example");
  HttpRequest asks = request("OPTIONS", "https://app.example");
  asks.headers.emplace_back("access-control-request-method", "PUT");
  const HttpResponse told = some.options(asks, Place::job);
  CHECK(told.status == 204);
  CHECK(header(told, "Access-Control-Allow-Methods").find("PUT") != std::string::npos);
  CHECK(header(told, "Access-Control-Allow-Headers").find("Idempotency-Key") != std::string::npos);
  asks.headers.at(1).second = "https://evil.example";
  const HttpResponse refused = some.options(asks, Place::job);
  CHECK(refused.status == 204);
  CHECK(header(refused, "Access-Control-Allow-Methods").empty());
  CHECK(header(refused, "Allow") == "GET, HEAD, PUT, DELETE, OPTIONS");
}
