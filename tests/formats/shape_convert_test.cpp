// From any format to any other.

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "core/triangle_mesh.h"
#include "proto/formats/bytes.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/messages/format.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

Bytes converted(const Decoded& document, Format came, Format wanted) {
  const auto out = convert(*document, unmoved(*document), came, wanted);
  REQUIRE(out);
  return *out;
}

/// Positions and triangles after welding: what every format must keep.
IndexedMesh welded(const Decoded& document) {
  const auto mesh = TriangleMesh::build(document->surfaces().at(0).mesh);
  REQUIRE(mesh);
  IndexedMesh out{mesh->positions(), mesh->faces()};
  for (Vec3& position : out.positions) position += mesh->origin();
  return out;
}

}  // namespace

TEST_CASE("chains through all formats keep positions and triangles") {
  const auto start = decoded(cube_sample().glb());
  const IndexedMesh expected = welded(start);
  Bytes bytes = converted(start, Format::glb, Format::glb);
  Format came = Format::glb;
  for (const Format next :
       {Format::ply, Format::obj, Format::stl, Format::ply, Format::stl, Format::obj, Format::ply,
        Format::glb, Format::obj, Format::gltf, Format::stl, Format::glb}) {
    bytes = converted(decoded(bytes, came), came, next);
    CAPTURE(name_of(came), name_of(next));
    const auto head = std::span(bytes).first(std::min(bytes.size(), kMagicBytes));
    const auto recognised = recognise_format(head, "", "");
    REQUIRE(recognised);
    CHECK(*recognised == next);
    came = next;
    const IndexedMesh found = welded(decoded(bytes, came));
    REQUIRE(found.triangles.size() == expected.triangles.size());
    for (std::size_t t = 0; t < found.triangles.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3& was = expected.positions[expected.triangles[t][c]];
        CHECK((found.positions[found.triangles[t][c]] - was).norm() < 1e-6);
      }
    }
  }
}

TEST_CASE("a Draco mesh and a moved glTF become PLY with normals and curvature") {
  const auto document = decoded(draco_cube({false, true, true, true}), Format::drc);
  auto results = shifted(*document, Vec3(1, 0, 0));
  add_ramp(*document, "_CURVATURE_K2", 1, results);
  const auto out = convert(*document, results, Format::drc, Format::ply);
  REQUIRE(out);
  CHECK(as_text(*out).find("property float nz\nproperty float curvature_k2\n") !=
        std::string_view::npos);
  const auto again = decoded(*out, Format::ply);
  for (std::size_t v = 0; v < 8; ++v) {
    CHECK((again->surfaces()[0].mesh.positions[v] - results[0].positions[v]).norm() < 1e-6);
  }
  CHECK(again->surfaces()[0].normals.size() == 8);
}

TEST_CASE("what a format has no place for is said") {
  const auto document = decoded(cube_sample().glb());
  auto results = unmoved(*document);
  CHECK(conversion_notes(results, Format::glb, Format::glb).empty());
  CHECK(conversion_notes(results, Format::stl, Format::stl).empty());
  add_ramp(*document, "_CURVATURE_K2", 1, results);
  CHECK(conversion_notes(results, Format::ply, Format::ply).empty());
  CHECK(conversion_notes(results, Format::drc, Format::drc).empty());
  CHECK(conversion_notes(results, Format::drc, Format::glb).empty());
  CHECK(conversion_notes(results, Format::glb, Format::drc).size() == 1);
  CHECK(conversion_notes(results, Format::obj, Format::obj).size() == 1);
  CHECK(conversion_notes(results, Format::glb, Format::stl).size() == 2);
}

TEST_CASE("several meshes do not become one silently") {
  SampleGlb sample = cube_sample();
  sample.json["meshes"].push_back(sample.json["meshes"][0]);
  const auto two = decoded(sample.glb());
  REQUIRE(two->surfaces().size() == 2);
  const auto refused = convert(*two, unmoved(*two), Format::glb, Format::ply);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::unsupported_feature);
}

TEST_CASE("double coordinates far from the origin survive OBJ to PLY") {
  const std::string obj = "v 500000.125 5000000.25 0\nv 500001 5000000 0\nv 500000 5000001 0\n";
  const auto document = decoded(text_bytes(obj + "f 1 2 3\n"), Format::obj);
  const auto ply = decoded(converted(document, Format::obj, Format::ply), Format::ply);
  CHECK(ply->surfaces()[0].mesh.positions == document->surfaces()[0].mesh.positions);
}
