// The documentation: its pages lead somewhere, load nothing foreign, and say what is so.

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "proto/messages/cost_estimate.h"
#include "proto/messages/parameters.h"
#include "server/fairwayd/settings/settings.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// All that the group matches.
std::vector<std::string> found(const std::string& text, const char* pattern) {
  const std::regex what(pattern);
  std::vector<std::string> out;
  for (std::sregex_iterator at(text.begin(), text.end(), what), end; at != end; ++at) {
    out.push_back((*at)[1]);
  }
  return out;
}

std::set<std::string> set_of(const std::vector<std::string>& list) {
  return {list.begin(), list.end()};
}

bool is_page(const Answer& answer) {
  return answer.header("content-type").starts_with("text/html");
}

/// The pages below /docs that the first one leads to, by their paths.
std::map<std::string, Answer> pages_of(const HttpClient& client) {
  std::map<std::string, Answer> pages;
  std::vector<std::string> ahead = {"/docs"};
  while (!ahead.empty()) {
    const std::string path = ahead.back();
    ahead.pop_back();
    if (pages.count(path) != 0) continue;
    const Answer answer = client.get(path);
    CAPTURE(path);
    REQUIRE(answer.status == 200);
    if (!is_page(answer)) continue;
    pages.emplace(path, answer);
    for (const std::string& link : found(answer.body, "href=\"(/docs[^\"#]*)")) {
      ahead.push_back(link);
    }
  }
  return pages;
}

/// Width and height in the head of a PNG file.
std::string size_of(const std::string& png) {
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8U | static_cast<unsigned char>(png.at(at + i));
    return value;
  };
  return fmt::format("width=\"{}\" height=\"{}\"", number(16), number(20));
}

std::string unescaped(std::string text) {
  for (std::size_t at = 0; (at = text.find("&quot;", at)) != std::string::npos;) {
    text.replace(at, 6, "\"");
  }
  return text;
}

/// The service and one of its pages.
struct Stage {
  TemporaryDirectory directory;
  ServiceProcess service{directory.path()};
  HttpClient client = service.client();

  std::string page(const char* path) const { return client.get(path).body; }
};

}  // namespace

TEST_CASE("the pages of the documentation lead to one another and to nothing that is not there") {
  const Stage stage;
  const auto pages = pages_of(stage.client);
  for (const char* path :
       {"/docs", "/docs/parameters", "/docs/gallery", "/docs/operations", "/docs/api"}) {
    CHECK(pages.count(path) == 1);
  }
  for (const auto& [path, page] : pages) {
    CAPTURE(path);
    for (const std::string& link : found(page.body, "(?:href|src)=\"([^\"]*)\"")) {
      CAPTURE(link);
      if (link.starts_with('#')) {
        CHECK(page.body.find("id=\"" + link.substr(1) + '"') != std::string::npos);
      } else {
        REQUIRE(link.starts_with('/'));
        CHECK(stage.client.get(link).status == 200);
      }
    }
  }
}

TEST_CASE("the pages of the documentation need no code, but that of the contract") {
  const Stage stage;
  for (const auto& [path, page] : pages_of(stage.client)) {
    CAPTURE(path);
    CHECK(page.header("content-type") == "text/html; charset=utf-8");
    CHECK(page.header("content-security-policy").starts_with("default-src 'none';"));
    CHECK_FALSE(page.header("etag").empty());
    CHECK(found(page.body, "(<style|style=|\\son[a-z]+=|javascript:|<iframe|<form)").empty());
    CHECK(found(page.body, "(<script)").size() == (path == "/docs/api" ? 1U : 0U));
    CHECK(found(page.body, "(<h1)").size() == 1);
    CHECK(found(page.body, "(<html lang=\"en\">)").size() == 1);
  }
}

TEST_CASE("the pictures of the documentation are small, of the size told, and described") {
  const Stage stage;
  constexpr std::size_t kMostBytes = 80'000;
  constexpr std::size_t kMostTogether = 1'000'000;
  std::map<std::string, std::size_t> bytes;
  for (const char* path : {"/docs/parameters", "/docs/gallery"}) {
    for (const std::string& tag : found(stage.page(path), "(<img [^>]*>)")) {
      CAPTURE(tag);
      const auto source = found(tag, "src=\"([^\"]*)\"");
      REQUIRE(source.size() == 1);
      const Answer picture = stage.client.get(source.front());
      CHECK(picture.header("content-type") == "image/png");
      CHECK(picture.body.size() <= kMostBytes);
      CHECK(tag.find(size_of(picture.body)) != std::string::npos);
      CHECK(found(tag, "alt=\"([^\"]+)\"").size() == 1);
      bytes[source.front()] = picture.body.size();
    }
  }
  std::size_t together = 0;
  for (const auto& [path, count] : bytes) together += count;
  CHECK(bytes.size() > 40);
  CHECK(together <= kMostTogether);
}

TEST_CASE("every metric has its row in the guide, and the guide names no other one") {
  const Stage stage;
  const std::string metrics = stage.page("/metrics");
  const std::string guide = stage.page("/docs/operations");
  const auto there = set_of(found(metrics, "# HELP (fairway_\\w+)"));
  CHECK(there.size() > 10);
  CHECK(set_of(found(guide, "<tr><td><code>(fairway_\\w+)</code>")) == there);
  for (std::string name : found(guide, "\\b(fairway_\\w+)")) {
    CAPTURE(name);
    if (name.ends_with("_bucket")) name.erase(name.size() - 7);
    CHECK(there.count(name) == 1);
  }
}

TEST_CASE("every setting has its row in the guide, with its default") {
  const Stage stage;
  const std::string guide = stage.page("/docs/operations");
  const std::vector<const char*> arguments = {"--data", "somewhere"};
  const auto settings = parse_settings(arguments);
  REQUIRE(settings);
  const std::string printed = print_settings(*settings);
  const auto names = found(printed, "\n([a-z-]+) =");
  CHECK(set_of(found(guide, "<tr><td><code>--([a-z-]+)</code>")) == set_of(names));
  for (const std::string& name : names) {
    if (name == "data" || name == "workers" || name == "worker") continue;  // of this machine
    const auto value = found(printed, ("\n" + name + " = ([^\n]*)").c_str());
    REQUIRE(value.size() == 1);
    CAPTURE(name, value.front());
    CHECK(guide.find("<code>--" + name + "</code></td><td>" + value.front() + "</td>") !=
          std::string::npos);
  }
}

TEST_CASE("the guide sizes as inspections do") {
  const Stage stage;
  const std::string guide = stage.page("/docs/operations");
  CostSubject million;
  million.format = Format::glb;
  million.bytes = 36'000'000;
  million.vertices = 1'000'000;
  million.triangles = 2'000'000;
  million.steps = 24;
  million.vertex_steps = 24e6;
  const CostEstimate cost = estimate_cost(million);
  const std::string said =
      fmt::format("a GLB of a million vertices takes at most {:.1f} s and {:.2f} GB", cost.seconds,
                  1e-9 * static_cast<double>(cost.memory_bytes));
  CAPTURE(said);
  CHECK(guide.find(said) != std::string::npos);
}

TEST_CASE("every parameter document in the documentation is accepted") {
  const Stage stage;
  const std::string page = stage.page("/docs/parameters");
  const auto documents = found(page, "<code>(\\{[^<]*\\})</code>");
  CHECK(documents.size() > 20);
  for (const std::string& document : documents) {
    const auto parsed = parse_parameters(unescaped(document));
    CAPTURE(document);
    CHECK(parsed);
  }
}
