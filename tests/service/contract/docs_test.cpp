// The page that shows the contract.

#include <regex>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/api/routes.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// What the attributes src and href of a page name.
std::set<std::string> links_of(const std::string& page) {
  const std::regex link(R"re((src|href)="([^"]*)")re");
  std::set<std::string> out;
  for (std::sregex_iterator at(page.begin(), page.end(), link), end; at != end; ++at) {
    out.insert((*at)[2]);
  }
  return out;
}

bool has(const std::string& text, const char* pattern) {
  return std::regex_search(text, std::regex(pattern));
}

}  // namespace

TEST_CASE("the page of the contract loads only its own files and needs no inline code") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer page = client.get("/docs/api");
  REQUIRE(page.status == 200);
  CHECK(page.header("content-type") == "text/html; charset=utf-8");
  CHECK(
      page.header("content-security-policy").starts_with("default-src 'none'; script-src 'self';"));
  CHECK(links_of(page.body) == std::set<std::string>{"/docs", "/docs/api", "/docs/app.js",
                                                     "/docs/gallery", "/docs/operations",
                                                     "/docs/parameters", "/docs/style.css",
                                                     "/openapi.json"});
  for (const std::string& link : links_of(page.body)) CHECK(client.get(link).status == 200);
  // What `default-src 'self'` would block.
  CHECK_FALSE(has(page.body, "<style|style=|\\son[a-z]+=|javascript:"));
  CHECK_FALSE(has(page.body, "<script(?![^>]*\\ssrc=)"));
  const std::string code = client.get("/docs/app.js").body;
  const std::string style = client.get("/docs/style.css").body;
  CHECK_FALSE(has(code, "\\beval\\(|new Function|innerHTML|\\.style\\b|https?://|import\\("));
  CHECK_FALSE(has(style, "@import|url\\("));
  CHECK(client.get("/docs/app.js").header("x-content-type-options") == "nosniff");
}

TEST_CASE("the page of the contract asks for what the service has") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const std::string code = service.client().get("/docs/app.js").body;
  for (const char* path : {"/openapi.json", "/v1/methods"}) {
    CAPTURE(path);
    CHECK(code.find(std::string("json('") + path + "')") != std::string::npos);
    CHECK(route_of(path));
  }
}
