// Strict JSON.

#include "proto/messages/json.h"

#include <string>

#include <catch2/catch.hpp>

namespace fairway::test {

TEST_CASE("JSON keeps the order of its keys and the values of its numbers") {
  const std::string text = R"({"z":1,"a":[0.1,-3,18446744073709551615,true,null],"m":{"x":"é"}})";
  const Result<Json> json = parse_json(text);
  REQUIRE(json);
  CHECK(dump_json(*json) == text);
}

TEST_CASE("JSON nested deeper than the limit is refused, however deep") {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  CHECK(parse_json(nested(64)));
  CHECK_FALSE(parse_json(nested(65)));
  CHECK_FALSE(parse_json(nested(1'000'000)));
  CHECK_FALSE(parse_json(std::string(100'000, '[')));
}

TEST_CASE("JSON with duplicate keys is refused") {
  CHECK_FALSE(parse_json(R"({"a":1,"a":2})"));
  CHECK(parse_json(R"({"a":{"a":1},"b":[{"a":1},{"a":2}]})"));
}

TEST_CASE("text that is not JSON is refused with malformed_input") {
  const auto* text = GENERATE("", "{", "{\"a\":1,}", "NaN", "[Infinity]", "1e999", "{} {}", "'a'",
                              "// no\n1", "\"\x01\"", "\"\xff\xfe\"");
  INFO(text);
  const Result<Json> json = parse_json(text);
  REQUIRE_FALSE(json);
  CHECK(json.error().code == ErrorCode::malformed_input);
}

TEST_CASE("a NUL byte is not the end of a document") {
  CHECK_FALSE(parse_json(std::string_view("{}\0x", 4)));
  CHECK_FALSE(parse_json(std::string_view("{}\0", 3)));
}

TEST_CASE("a byte order mark before JSON is skipped") {
  CHECK(parse_json("\xEF\xBB\xBF{\"a\":1}"));
}

TEST_CASE("pointers escape what RFC 6901 says") {
  CHECK(child_pointer("/a", "b~/c") == "/a/b~0~1c");
}

}  // namespace fairway::test
