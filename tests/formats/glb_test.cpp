#include "proto/formats/glb.h"

#include <catch2/catch.hpp>

#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

ErrorCode refusal(const Bytes& bytes) {
  const auto document = decode(bytes, Format::glb);
  REQUIRE_FALSE(document);
  return document.error().code;
}

void set_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = std::byte(value >> (8 * i) & 0xFFU);
}

}  // namespace

TEST_CASE("every truncation of a valid GLB is refused as malformed") {
  const Bytes whole = cube_sample().glb();
  REQUIRE(decode(whole, Format::glb));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(refusal(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))) ==
          ErrorCode::malformed_input);
  }
}

TEST_CASE("GLB lengths that contradict each other are refused as malformed") {
  const Bytes whole = cube_sample().glb();
  for (const std::uint32_t length : {0U, 12U, 0x7FFFFFFFU, 0xFFFFFFF0U, 0xFFFFFFFFU}) {
    CAPTURE(length);
    Bytes total = whole;
    set_u32(total, 8, length);
    CHECK(refusal(total) == ErrorCode::malformed_input);
    Bytes json = whole;
    set_u32(json, 12, length);
    CHECK(refusal(json) == ErrorCode::malformed_input);
  }
  Bytes longer = whole;
  longer.resize(longer.size() + 64);
  CHECK(refusal(longer) == ErrorCode::malformed_input);
}

TEST_CASE("GLB of another magic or version is an unsupported format") {
  Bytes magic = cube_sample().glb();
  magic[0] = std::byte('x');
  CHECK(refusal(magic) == ErrorCode::unsupported_format);
  Bytes version = cube_sample().glb();
  set_u32(version, 4, 1);
  CHECK(refusal(version) == ErrorCode::unsupported_format);
}

TEST_CASE("GLB chunks of other kinds survive a round trip") {
  Bytes bytes = cube_sample().glb();
  const Bytes extra = text_bytes(std::string("\x04\0\0\0XTRAdata", 12));
  bytes.insert(bytes.end(), extra.begin(), extra.end());
  set_u32(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
  const auto document = decoded(bytes);
  const auto out = document->encode(shifted(*document, Vec3(1, 0, 0)), Format::glb);
  REQUIRE(out);
  REQUIRE(out->size() > extra.size());
  CHECK(Bytes(out->end() - static_cast<std::ptrdiff_t>(extra.size()), out->end()) == extra);
}

TEST_CASE("GLB whose JSON chunk is padded with zeros is read") {
  SampleGlb sample = cube_sample();
  sample.json["asset"]["extras"] = "";
  while (sample.json.dump().size() % 4 != 1) {
    sample.json["asset"]["extras"].get_ref<std::string&>() += 'x';
  }
  Bytes bytes = sample.glb();
  const std::size_t end = 20 + (sample.json.dump().size() + 3) / 4 * 4;
  for (std::size_t i = end - 3; i < end; ++i) bytes[i] = std::byte{0};
  CHECK(decode(bytes, Format::glb));
}
