// Streams of meshopt, made by meshoptimizer's own encoder.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include <catch2/catch.hpp>
#include <meshoptimizer.h>

#include "proto/formats/meshopt_decoder.h"
#include "tests/formats/meshopt_samples.h"

namespace fairway::test {
namespace {

using Mode = MeshoptMode;
using Filter = MeshoptFilter;

std::vector<float> wave(std::size_t count) {
  std::vector<float> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = std::sin(0.1F * static_cast<float>(i));
  return out;
}

ErrorCode refusal(const Bytes& stream, const MeshoptLayout& layout) {
  const auto decoded = decode_meshopt(stream, layout);
  REQUIRE_FALSE(decoded);
  return decoded.error().code;
}

}  // namespace

TEST_CASE("meshopt attributes decode to the bytes that were encoded") {
  const std::size_t stride = GENERATE(as<std::size_t>{}, 4, 12, 16, 256);
  const std::size_t count = GENERATE(as<std::size_t>{}, 1, 15, 300);
  const Bytes bytes = bytes_of(wave(count * stride / 4));
  const auto decoded = decode_meshopt(meshopt_attributes(bytes, stride),
                                      {Mode::attributes, Filter::none, count, stride});
  REQUIRE(decoded);
  CHECK(*decoded == bytes);
}

TEST_CASE("meshopt triangles and index sequences decode to the same corners") {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < 200; ++i) {
    for (const std::uint32_t corner : {i, i + 1, i + 20}) indices.push_back(corner);
  }
  const auto sequence =
      decode_meshopt(meshopt_sequence(indices), {Mode::indices, Filter::none, 600, 4});
  REQUIRE(sequence);
  CHECK(*sequence == bytes_of(indices));
  const auto narrow =
      decode_meshopt(meshopt_triangles(indices), {Mode::triangles, Filter::none, 600, 2});
  REQUIRE(narrow);
  for (std::size_t i = 0; i < 600; i += 3) {
    std::array<std::uint16_t, 3> corners{};
    std::memcpy(corners.data(), narrow->data() + 2 * i, 6);
    // The codec may turn a triangle, not flip it.
    const auto first = static_cast<std::size_t>(
        std::find(corners.begin(), corners.end(), indices[i]) - corners.begin());
    REQUIRE(first < 3);
    CHECK(corners[(first + 1) % 3] == indices[i + 1]);
    CHECK(corners[(first + 2) % 3] == indices[i + 2]);
  }
}

TEST_CASE("meshopt filters give back what they were made from within their bits") {
  const std::vector<float> unit = {0.6F, 0.0F, 0.8F, 0.0F, 0.0F, -1.0F, 0.0F, 0.0F};
  Bytes octahedral(16);
  meshopt_encodeFilterOct(octahedral.data(), 2, 8, 16, unit.data());
  const auto normals = decode_meshopt(meshopt_attributes(octahedral, 8),
                                      {Mode::attributes, Filter::octahedral, 2, 8});
  REQUIRE(normals);
  const std::vector<float> rotations = {0.6F, 0.0F, 0.0F, 0.8F, 0.5F, 0.5F, 0.5F, 0.5F};
  Bytes quaternion(16);
  meshopt_encodeFilterQuat(quaternion.data(), 2, 8, 16, rotations.data());
  const auto quaternions = decode_meshopt(meshopt_attributes(quaternion, 8),
                                          {Mode::attributes, Filter::quaternion, 2, 8});
  REQUIRE(quaternions);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto at = [i](const Bytes& bytes) { return load<std::int16_t>(&bytes[2 * i]) / 32767.0; };
    CHECK(at(*normals) == Approx(unit[i]).margin(1e-3));
    CHECK(at(*quaternions) == Approx(rotations[i]).margin(1e-3));
  }
  const std::vector<float> values = wave(24);
  Bytes exponential(96);
  meshopt_encodeFilterExp(exponential.data(), 8, 12, 15, values.data());
  const auto floats = decode_meshopt(meshopt_attributes(exponential, 12),
                                     {Mode::attributes, Filter::exponential, 8, 12});
  REQUIRE(floats);
  for (std::size_t i = 0; i < 24; ++i) {
    CHECK(load<float>(&(*floats)[4 * i]) == Approx(values[i]).margin(1e-3));
  }
}

TEST_CASE("meshopt layouts that break a rule are refused before anything is allocated") {
  const Bytes stream = meshopt_attributes(bytes_of(wave(64)), 16);
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 53;
  const std::vector<MeshoptLayout> broken = {
      {Mode::attributes, Filter::none, 16, 0},        {Mode::attributes, Filter::none, 16, 6},
      {Mode::attributes, Filter::none, 16, 260},      {Mode::attributes, Filter::none, 0, 16},
      {Mode::attributes, Filter::octahedral, 16, 16}, {Mode::attributes, Filter::quaternion, 16, 4},
      {Mode::attributes, Filter::none, kHuge, 16},    {Mode::attributes, Filter::none, kHuge, 256},
      {Mode::triangles, Filter::none, 4, 2},          {Mode::triangles, Filter::none, 6, 8},
      {Mode::triangles, Filter::none, kHuge / 3, 4},  {Mode::indices, Filter::none, kHuge, 4},
      {Mode::indices, Filter::octahedral, 6, 4},      {Mode::indices, Filter::none, 6, 1}};
  for (const MeshoptLayout& layout : broken) {
    CAPTURE(layout.count, layout.stride);
    CHECK(refusal(stream, layout) == ErrorCode::invalid_mesh);
  }
  CHECK(refusal({}, {Mode::attributes, Filter::none, 16, 16}) == ErrorCode::invalid_mesh);
  Bytes newer = stream;
  newer[0] = std::byte{0xA1};
  CHECK(refusal(newer, {Mode::attributes, Filter::none, 16, 16}) == ErrorCode::unsupported_feature);
}

TEST_CASE("every truncation of a meshopt stream is refused, flipped bits do no harm") {
  std::vector<std::uint32_t> indices(300);
  std::iota(indices.begin(), indices.end(), 0U);
  struct Case {
    Bytes stream;
    MeshoptLayout layout;
  };
  const std::vector<Case> cases = {
      {meshopt_attributes(bytes_of(wave(300)), 12), {Mode::attributes, Filter::none, 100, 12}},
      {meshopt_triangles(indices), {Mode::triangles, Filter::none, 300, 4}},
      {meshopt_sequence(indices), {Mode::indices, Filter::none, 300, 2}}};
  for (const auto& [stream, layout] : cases) {
    for (std::size_t size = 0; size < stream.size(); ++size) {
      const Bytes cut(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
      CHECK_FALSE(decode_meshopt(cut, layout));
    }
    for (std::size_t bit = 0; bit < 8 * stream.size(); ++bit) {
      Bytes flipped = stream;
      flipped[bit / 8] ^= std::byte(1U << (bit % 8));
      const auto decoded = decode_meshopt(flipped, layout);
      if (decoded) CHECK(decoded->size() == layout.count * layout.stride);
    }
  }
}

}  // namespace fairway::test
