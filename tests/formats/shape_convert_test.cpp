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
  CHECK(conversion_notes(*document, results, Format::glb, Format::glb).empty());
  CHECK(conversion_notes(*document, results, Format::stl, Format::stl).empty());
  add_ramp(*document, "_CURVATURE_K2", 1, results);
  CHECK(conversion_notes(*document, results, Format::ply, Format::ply).empty());
  CHECK(conversion_notes(*document, results, Format::drc, Format::drc).empty());
  CHECK(conversion_notes(*document, results, Format::drc, Format::glb).empty());
  CHECK(conversion_notes(*document, results, Format::obj, Format::obj).size() == 1);
  CHECK_FALSE(conversion_notes(*document, results, Format::glb, Format::stl).empty());
}

TEST_CASE("the note of a conversion lists what this file loses, and only that") {
  const auto note = [](const Decoded& document, Format came, Format wanted) {
    const auto notes = conversion_notes(*document, unmoved(*document), came, wanted);
    CHECK(notes.size() <= 1);
    return notes.empty() ? std::string() : notes.front();
  };
  SampleGlb scene = cube_sample();
  for (const char* key : {"materials", "textures", "images", "samplers"}) scene.json.erase(key);
  scene.json["nodes"] = Json::array({{{"mesh", 0}}});
  Json& primitive = scene.json["meshes"][0]["primitives"][0];
  const Json position = primitive["attributes"]["POSITION"];
  primitive["attributes"] = {{"POSITION", position}};
  primitive.erase("material");
  CHECK(note(decoded(scene.glb()), Format::glb, Format::ply).empty());
  scene.json["nodes"][0]["scale"] = {2, 2, 2};
  scene.json["materials"] = Json::array({Json::object(), Json::object()});
  CHECK(note(decoded(scene.glb()), Format::glb, Format::ply) ==
        "written anew as ply, without 2 materials, transformations of nodes");

  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  CHECK(note(decoded(text_bytes(corners + "f 1 2 3\nf 1 3 4\n"), Format::obj), Format::obj,
             Format::glb)
            .empty());
  CHECK(note(decoded(text_bytes(corners + "vt 0 0\nvt 1 0\ng a\nusemtl b\nf 1/1 2/1 3/1 4/1\n"
                                          "f 1/2 2/1 3/1\n"),
                     Format::obj),
             Format::obj, Format::glb) ==
        "written anew as glb, without 2 texture coordinates, 1 choice of a material, 1 group, 1 "
        "polygon of more than three corners");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n";
  CHECK(note(decoded(text_bytes(ply), Format::ply), Format::ply, Format::stl) ==
        "written anew as stl, without 2 other properties of vertices");
}

TEST_CASE("a position that no float holds diverged if it moved, and is a bad mesh if it did not") {
  const auto document =
      decoded(text_bytes("v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Format::obj);
  const Surface& surface = document->surfaces().front();
  const auto refused = [&](const SurfaceResult& result) {
    const auto out = write_fresh_mesh(surface, result, Format::ply, {});
    REQUIRE_FALSE(out);
    return out.error().code;
  };
  CHECK(refused({}) == ErrorCode::invalid_mesh);
  SurfaceResult moved;
  moved.moved = true;
  moved.positions = surface.mesh.positions;
  CHECK(refused(moved) == ErrorCode::diverged);
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
