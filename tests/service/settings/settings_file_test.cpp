#include "server/fairwayd/settings/settings_file.h"

#include <string>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

std::string refusal(const std::string& text) {
  const auto lines = parse_settings_file(text, "f");
  CAPTURE(text);
  REQUIRE_FALSE(lines);
  CHECK(lines.error().code == ErrorCode::usage);
  return lines.error().message;
}

}  // namespace

TEST_CASE("a settings file is lines of name = value, with comments and blanks") {
  const auto lines = parse_settings_file(
      "# all\n\n  data =  /a b/c=d \r\n\t# not\nworkers=2\nworker =\nx = a#b", "f");
  REQUIRE(lines);
  REQUIRE(lines->size() == 4);
  CHECK(lines->at(0).name == "data");
  CHECK(lines->at(0).value == "/a b/c=d");
  CHECK(lines->at(0).line == 3);
  CHECK(lines->at(1).value == "2");
  CHECK(lines->at(1).line == 5);
  CHECK(lines->at(2).value.empty());
  CHECK(lines->at(3).value == "a#b");
  CHECK(parse_settings_file("", "f")->empty());
}

TEST_CASE("a line of a settings file that cannot be meant is refused by its number") {
  CHECK(refusal("a = 1\nworkers\n").starts_with("f:2 "));
  CHECK(refusal("\n\n = 3").starts_with("f:3 "));
  CHECK(refusal("a = 1\nb = 2\na = 1\n") == "f:3 sets a again, after line 1.");
  CHECK(refusal("workers = 2 # two").find("lines of their own") != std::string::npos);
  CHECK(refusal("data = # none").starts_with("f:1 "));
}

TEST_CASE("a settings file that is not there, or endless, is refused") {
  CHECK(read_settings_file("/nonexistent/file").error().code == ErrorCode::io);
  const auto endless = read_settings_file("/dev/zero");
  REQUIRE_FALSE(endless);
  CHECK(endless.error().message.find("is longer than") != std::string::npos);
  CHECK(read_settings_file("/").error().code == ErrorCode::io);
}
