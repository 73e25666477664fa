#include "server/fairwayd/http/http_prefer.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

/// What is heeded of some Prefer headers, as Preference-Applied says it.
std::string heeded(const std::vector<std::string>& values) {
  HttpRequest request;
  for (const std::string& value : values) request.headers.emplace_back("prefer", value);
  return applied_text(preferences_of(request));
}

}  // namespace

TEST_CASE("preferences are read from all headers, in any case, quoted or not") {
  CHECK(heeded({}).empty());
  CHECK(heeded({"respond-async, wait=10"}) == "respond-async, wait=10");
  CHECK(heeded({"Wait=10", "Respond-Async"}) == "respond-async, wait=10");
  CHECK(heeded({R"(wait="7")"}) == "wait=7");
  CHECK(heeded({R"(respond-async="")"}) == "respond-async");
  CHECK(heeded({" wait = 5 ; foo=bar; baz , handling=lenient"}) == "wait=5");
  CHECK(heeded({R"(foo="a, wait=9", wait=3)"}) == "wait=3");
}

TEST_CASE("of a preference that is stated twice the first counts") {
  CHECK(heeded({"wait=3, wait=4"}) == "wait=3");
  CHECK(heeded({"wait=3", "wait=4"}) == "wait=3");
  CHECK(heeded({"wait=never, wait=4"}).empty());
}

TEST_CASE("a preference that does not parse is ignored") {
  for (const char* value : {"wait", "wait=", "wait=-1", "wait=1.5", "wait=x", "wait=1 2", "w ait=1",
                            R"(wait="1)", "respond-async=yes", ";wait=3", "=", ",,"}) {
    CAPTURE(value);
    CHECK(heeded({value}).empty());
  }
}

TEST_CASE("a wait is at most a day") {
  CHECK(heeded({"wait=99999999999999999999999"}) == "wait=86400");
}
