#include <cmath>

#include <catch2/catch.hpp>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kText =
    "solid my part 7\n  facet normal 0 0 nan\n    outer loop\n      vertex 0.0 0 0\n"
    "      vertex 1 0 0\n      vertex 0 1 0\n    endloop\n  endfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex -0.0 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nendsolid my part 7\n";

/// The cube of the samples, `header` first, attribute bytes 7, 8, 9 …
Bytes binary_cube(const std::string& header) {
  Bytes out = text_bytes(header);
  out.resize(80, std::byte{'x'});
  const auto corners = cube_corners();
  const auto indices = cube_indices();
  append_value(out, static_cast<std::uint32_t>(indices.size() / 3));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (i % 3 == 0) append_value(out, std::array<float, 3>{0, 0, 0});
    append_value(out, corners[indices[i]]);
    if (i % 3 == 2) append_value(out, static_cast<std::uint16_t>(7 + i / 3));
  }
  append(out, as_bytes("trailer"));
  return out;
}

ErrorCode refusal(const Bytes& bytes) {
  const auto document = decode(bytes, Format::stl);
  REQUIRE_FALSE(document);
  CHECK(document.error().message.size() > 20);
  return document.error().code;
}

}  // namespace

TEST_CASE("a binary STL is welded and keeps header, attributes and what is behind") {
  const Bytes before = binary_cube(GENERATE("a header", "solid and yet binary\nfoo"));
  const auto document = decoded(before, Format::stl);
  const Surface& surface = document->surfaces().at(0);
  CHECK(surface.mesh.positions.size() == 8);
  CHECK(surface.mesh.triangles.size() == 12);
  CHECK(*document->encode(unmoved(*document), Format::stl) == before);
  const auto results = shifted(*document, Vec3(0.5, 0, 0));
  const Bytes after = *document->encode(results, Format::stl);
  REQUIRE(after.size() == before.size());
  CHECK(std::equal(before.begin(), before.begin() + 84, after.begin()));
  CHECK(as_text(after).substr(after.size() - 7) == "trailer");
  for (std::size_t t = 0; t < 12; ++t) {
    const std::byte* at = after.data() + 84 + 50 * t;
    CHECK(load<std::uint16_t>(at + 48) == 7 + t);
    const auto normal = load<std::array<float, 3>>(at);
    CHECK(std::hypot(normal[0], normal[1], normal[2]) == 1.0F);
    const auto corner = load<std::array<float, 3>>(at + 12);
    CHECK(normal[1] * corner[1] + normal[2] * corner[2] + normal[0] * (corner[0] - 0.5F) == 1.0F);
  }
  const auto again = decoded(after, Format::stl);
  CHECK(again->surfaces()[0].mesh.positions == results[0].positions);
  CHECK(again->surfaces()[0].mesh.triangles == surface.mesh.triangles);
}

TEST_CASE("an ASCII STL stays a text with its names, and gets new normals") {
  const auto document = decoded(text_bytes(kText), Format::stl);
  CHECK(document->surfaces()[0].mesh.positions.size() == 4);
  CHECK(document->surfaces()[0].mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  CHECK(as_text(*document->encode(unmoved(*document), Format::stl)) == kText);
  const Bytes out = *document->encode(shifted(*document, Vec3(0, 0, 0.1)), Format::stl);
  CHECK(as_text(out) ==
        "solid my part 7\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0.1\n"
        "      vertex 1 0 0.1\n      vertex 0 1 0.1\n    endloop\n  endfacet\n"
        "facet normal 1 0 0\nouter loop\nvertex 0 0 0.1\nvertex 0 1 0.1\nvertex 0 0 1.1\nendloop\n"
        "endfacet\nendsolid my part 7\n");
}

TEST_CASE("the keywords of an ASCII STL may be in capitals") {
  const Bytes bytes = text_bytes(
      "SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\n"
      "ENDLOOP\nENDFACET\nENDSOLID A\n");
  CHECK(decoded(bytes, Format::stl)->surfaces()[0].mesh.triangles.size() == 1);
}

TEST_CASE("every truncation of an STL is refused") {
  const Bytes binary = binary_cube("header");
  for (std::size_t size = 0; size < binary.size() - 7; ++size) {
    const ErrorCode code =
        refusal(Bytes(binary.begin(), binary.begin() + static_cast<std::ptrdiff_t>(size)));
    CHECK((code == ErrorCode::malformed_input || code == ErrorCode::invalid_mesh));
  }
  const Bytes text = text_bytes(kText);
  const std::size_t whole = kText.find("endsolid") + 8;
  for (std::size_t size = 0; size < whole; ++size) {
    CAPTURE(size);
    CHECK_FALSE(decode(std::span(text).first(size), Format::stl));
  }
}

TEST_CASE("broken facets of an STL are refused") {
  const auto with = [](const std::string& old, const std::string& now) {
    std::string stl = kText;
    return refusal(text_bytes(stl.replace(stl.find(old), old.size(), now)));
  };
  CHECK(with("vertex 1 0 0", "vertex nan 0 0") == ErrorCode::invalid_mesh);
  CHECK(with("vertex 1 0 0", "vertex 1e39 0 0") == ErrorCode::invalid_mesh);
  CHECK(with("vertex 1 0 0", "vertex 1 0") == ErrorCode::invalid_mesh);
  CHECK(with("vertex 1 0 0\n", "") == ErrorCode::invalid_mesh);
  CHECK(with("vertex 1 0 0", "vertex 1 0 0\nvertex 1 1 0") == ErrorCode::invalid_mesh);
  CHECK(with("outer loop", "inner loop") == ErrorCode::malformed_input);
  CHECK(with("normal 0 0 nan", "0 0 1") == ErrorCode::malformed_input);
  CHECK(with("normal 0 0 nan", "normal 0 0") == ErrorCode::malformed_input);
  CHECK(refusal(text_bytes("solid a\nendsolid\n")) == ErrorCode::no_triangles);
  Bytes many = binary_cube("h");
  many[83] = std::byte{0xFF};
  CHECK(refusal(many) == ErrorCode::invalid_mesh);
  Bytes nan = binary_cube("h");
  nan[84 + 15] = nan[84 + 14] = std::byte{0xFF};
  CHECK(refusal(nan) == ErrorCode::invalid_mesh);
}
