// Which vertices of a file a client's fixed vertices are.

#include "proto/formats/fixed_vertices.h"

#include <catch2/catch.hpp>

#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

using Lists = std::vector<std::vector<Index>>;

/// Three meshes: the first of points and of two cubes with vertices of their own, the second of
/// points only, the third of one cube.
SampleGlb many_cubes() {
  SampleGlb sample = cube_sample();
  const std::size_t other = sample.add_vec3(cube_corners());
  const Json points = {{"attributes", {{"POSITION", 0}}}, {"mode", 0}};
  const Json cube = sample.json["meshes"][0]["primitives"][0];
  Json second = cube;
  second["attributes"]["POSITION"] = other;
  sample.json["meshes"][0]["primitives"] = Json::array({points, cube, second});
  sample.add_mesh(Json::array({points}));
  sample.add_mesh(Json::array({cube}));
  return sample;
}

Lists found(const Document& document, const std::vector<FixedVertices>& fixed) {
  auto lists = find_fixed_vertices(document.surfaces(), fixed);
  if (!lists) FAIL(lists.error().message);
  return *std::move(lists);
}

void check_refused(const Document& document, const std::vector<FixedVertices>& fixed,
                   const std::string& pointer) {
  const auto lists = find_fixed_vertices(document.surfaces(), fixed);
  REQUIRE_FALSE(lists);
  CHECK(lists.error().code == ErrorCode::invalid_parameters);
  CHECK(lists.error().pointer == pointer);
  CHECK(lists.error().message.size() > 20);
}

FixedVertices at(std::size_t mesh, std::size_t primitive, std::vector<Index> vertices) {
  return {FixedVertices::Place{mesh, primitive}, std::move(vertices)};
}

FixedVertices anywhere(std::vector<Index> vertices) {
  return {std::nullopt, std::move(vertices)};
}

}  // namespace

TEST_CASE("a plain list names elements of the only POSITION accessor") {
  SampleGlb sample = cube_sample();
  CHECK(found(*decoded(sample.glb()), {anywhere({5, 0, 5})}) == Lists{{0, 5}});
  // Two primitives of one accessor, one with normals: the vertices are twice in the surface.
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["attributes"]["NORMAL"] =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, 1}));
  const auto document = decoded(sample.glb());
  REQUIRE(document->surfaces()[0].mesh.positions.size() == 16);
  CHECK(found(*document, {anywhere({7})}) == Lists{{7}});
  CHECK(found(*document, {}) == Lists{{}});
}

TEST_CASE("a list with a place names elements of that primitive's POSITION accessor") {
  const auto document = decoded(many_cubes().glb());
  CHECK(found(*document, {at(2, 0, {3}), at(0, 2, {1, 0}), at(0, 1, {7, 0})}) ==
        Lists{{0, 7, 8, 9}, {3}});
}

TEST_CASE("what the file does not have is refused with the pointer of the culprit") {
  const auto document = decoded(many_cubes().glb());
  check_refused(*document, {anywhere({0})}, "/fixed_vertices");
  check_refused(*document, {at(0, 1, {0}), at(1, 0, {0})}, "/fixed_vertices/1/mesh");
  check_refused(*document, {at(3, 0, {0})}, "/fixed_vertices/0/mesh");
  check_refused(*document, {at(0, 0, {0})}, "/fixed_vertices/0/primitive");
  check_refused(*document, {at(0, 3, {0})}, "/fixed_vertices/0/primitive");
  check_refused(*document, {at(0, 1, {7, 8})}, "/fixed_vertices/0/vertices/1");
  SampleGlb two = many_cubes();
  two.json["meshes"].erase(2);
  two.json["meshes"].erase(1);
  check_refused(*decoded(two.glb()), {anywhere({0})}, "/fixed_vertices");
  const auto cube = decoded(cube_sample().glb());
  check_refused(*cube, {anywhere({1, 2, 8})}, "/fixed_vertices/2");
}

TEST_CASE("a Draco mesh has one list of vertices, its points") {
  const auto document = decoded(draco_cube(), Format::drc);
  const Index last = static_cast<Index>(document->surfaces()[0].mesh.positions.size() - 1);
  CHECK(found(*document, {anywhere({last})}) == Lists{{last}});
  CHECK(found(*document, {at(0, 0, {last})}) == Lists{{last}});
  check_refused(*document, {anywhere({last + 1})}, "/fixed_vertices/0");
}
