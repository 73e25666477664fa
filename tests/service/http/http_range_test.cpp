#include "server/fairwayd/http/http_range.h"

#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace fairway;

namespace {

/// "0-1 5-9", "whole" where the header is ignored, "refused" for a 416.
std::string ranges(std::string_view value, std::uint64_t bytes = 10) {
  const auto parsed = parse_range(value, bytes);
  if (!parsed) {
    CHECK(parsed.error().code == ErrorCode::range_not_satisfiable);
    return "refused";
  }
  std::string text;
  for (const ByteRange& range : *parsed) {
    CHECK(range.last < bytes);
    text += fmt::format("{}{}-{}", text.empty() ? "" : " ", range.first, range.last);
  }
  return text.empty() ? "whole" : text;
}

}  // namespace

TEST_CASE("a range is from a byte to a byte, to the end, or so many at the end") {
  CHECK(ranges("bytes=0-0") == "0-0");
  CHECK(ranges("bytes=2-5") == "2-5");
  CHECK(ranges("Bytes=7-") == "7-9");
  CHECK(ranges("bytes=-3") == "7-9");
  CHECK(ranges("bytes=-99") == "0-9");
  CHECK(ranges("bytes=5-99999999999999999999999999") == "5-9");
  CHECK(ranges("bytes= 0-1 ,, 3-4,\t-2") == "0-1 3-4 8-9");
}

TEST_CASE("a range beyond the end is left out, and refused where there is no other") {
  CHECK(ranges("bytes=10-") == "refused");
  CHECK(ranges("bytes=-0") == "refused");
  CHECK(ranges("bytes=10-11,20-") == "refused");
  CHECK(ranges("bytes=99999999999999999999999999-") == "refused");
  CHECK(ranges("bytes=1-2,10-") == "1-2");
}

TEST_CASE("what is no range of bytes is ignored") {
  for (const char* value : {"", "bytes", "bytes=", "bytes=,", "lines=0-1", "bytes =0-1", "bytes=-",
                            "bytes=5-2", "bytes=a-b", "bytes=1", "bytes=0-1,x", "bytes=0-1-2",
                            "bytes=--1", "bytes=+1-2", "bytes=0x1-2"}) {
    CAPTURE(value);
    CHECK(ranges(value) == "whole");
  }
}

TEST_CASE("ranges that overlap, descend or are too many are refused") {
  CHECK(ranges("bytes=0-4,4-5") == "refused");
  CHECK(ranges("bytes=0-,1-2") == "refused");
  CHECK(ranges("bytes=5-6,0-1") == "refused");
  CHECK(ranges("bytes=-3,0-1") == "refused");
  CHECK(ranges("bytes=0-0,0-0") == "refused");
  std::string many = "bytes=0-0";
  for (std::size_t i = 1; i < kMaxRanges; ++i) many += fmt::format(",{}-{}", 2 * i, 2 * i);
  CHECK(ranges(many, 100) == "0-0 2-2 4-4 6-6 8-8 10-10 12-12 14-14");
  CHECK(ranges(many + ",50-51", 100) == "refused");
}
