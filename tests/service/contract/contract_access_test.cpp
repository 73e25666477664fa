// Who may ask what, as the contract says it.

#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "proto/messages/openapi.h"
#include "server/fairwayd/api/routes.h"
#include "tests/service/contract/contract_walks.h"

namespace fairway::test {
namespace {

const std::string kApp = "https://app.example";

/// The entries of a list with commas, in lower case.
std::set<std::string> entries_of(std::string text) {
  std::set<std::string> out;
  for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  while (!text.empty()) {
    const std::size_t comma = text.find(", ");
    out.insert(text.substr(0, comma));
    text = comma == std::string::npos ? "" : text.substr(comma + 2);
  }
  return out;
}

/// What a page can read, or has no use for.
const std::set<std::string> kNotExposed = {"cache-control",
                                           "vary",
                                           "content-security-policy",
                                           "x-content-type-options",
                                           "x-accel-buffering",
                                           "www-authenticate",
                                           "allow",
                                           "content-encoding",
                                           "cross-origin-opener-policy",
                                           "referrer-policy"};

}  // namespace

TEST_CASE("the scope that an operation is documented to need is the one that is asked for") {
  for (const Operation& operation : operations_of(openapi_document())) {
    CAPTURE(operation.id);
    if (operation.method == "OPTIONS") {  // browsers ask without a key
      CHECK(operation.scope.empty());
      continue;
    }
    const auto route = route_of(path_with(operation, kNobody));
    REQUIRE(route);
    const auto scope = needed_scope(route->place, operation.method);
    CHECK(operation.scope == (scope ? std::string(name_of(*scope)) : ""));
  }
}

TEST_CASE("OPTIONS says of every path what it takes") {
  const Stage stage;
  for (const RoutePattern& route : route_patterns()) {
    CAPTURE(route.path);
    const Answer answer = stage.ask({"OPTIONS", filled(route.path, kNobody), {}, ""});
    CHECK(answer.status == 204);
    CHECK(answer.body.empty());
    CHECK(answer.header("allow") == std::string(route.methods) + ", OPTIONS");
  }
}

TEST_CASE("a page of a listed origin may read every documented answer") {
  const Stage stage({"--cors-origins", kApp});
  for (const Operation& operation : operations_of(openapi_document())) {
    CAPTURE(operation.id);
    const Answer answer =
        stage.ask({operation.method, path_with(operation, kNobody), {"Origin: " + kApp}, ""});
    CHECK(answer.status != 403);
    CHECK(answer.header("access-control-allow-origin") == kApp);
    CHECK(entries_of(answer.header("vary")).contains("origin"));
    const std::set<std::string> exposed =
        entries_of(answer.header("access-control-expose-headers"));
    for (const auto& [status, response] : operation.responses.items()) {
      const Json headers = response.value("headers", Json::object());
      for (const auto& [name, header] : headers.items()) {
        CAPTURE(name);
        const std::string lower = *entries_of(name).begin();
        CHECK((exposed.contains(lower) || kNotExposed.contains(lower)));
      }
    }
  }
}

TEST_CASE("a page of a listed origin may send every documented request") {
  const Stage stage({"--cors-origins", kApp});
  for (const Operation& operation : operations_of(openapi_document())) {
    CAPTURE(operation.id);
    const Answer answer =
        stage.ask({"OPTIONS",
                   path_with(operation, kNobody),
                   {"Origin: " + kApp, "Access-Control-Request-Method: " + operation.method},
                   ""});
    CHECK(answer.status == 204);
    CHECK(answer.header("access-control-allow-origin") == kApp);
    CHECK(entries_of(answer.header("access-control-allow-methods"))
              .contains(*entries_of(operation.method).begin()));
    const std::set<std::string> allowed = entries_of(answer.header("access-control-allow-headers"));
    CHECK(allowed.contains("authorization"));
    CHECK(allowed.contains("content-type"));
    for (const Json& parameter : operation.parameters) {
      if (parameter["in"] != "header") continue;
      const std::string name = parameter["name"];
      if (name == "Accept-Encoding") continue;  // a browser's own; no page may set it
      CAPTURE(name);
      CHECK(allowed.contains(*entries_of(name).begin()));
    }
  }
}

}  // namespace fairway::test
