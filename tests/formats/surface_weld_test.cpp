// Vertices as the file has them.

#include "proto/formats/surface_weld.h"

#include <catch2/catch.hpp>

#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("every element of the file is a vertex, at equal positions too") {
  SampleGlb sample = cube_sample();
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["attributes"]["POSITION"] = sample.add_vec3(cube_corners());
  const auto document = decoded(sample.glb());
  const Weld weld = weld_elements(document->surfaces()[0]);
  CHECK(weld.count == 16);
  for (Index i = 0; i < 16; ++i) CHECK(weld.place[i] == i);
}

TEST_CASE("an element that stands in a surface twice is one vertex") {
  SampleGlb sample = cube_sample();
  Json& primitives = sample.json["meshes"][0]["primitives"];
  // Another POSITION in between, then the first one with normals.
  primitives.push_back(primitives[0]);
  primitives[1]["attributes"]["POSITION"] = sample.add_vec3(cube_corners());
  primitives.push_back(primitives[0]);
  primitives[2]["attributes"]["NORMAL"] =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, 1}));
  const auto document = decoded(sample.glb());
  const Surface& surface = document->surfaces()[0];
  REQUIRE(surface.mesh.positions.size() == 24);
  const Weld weld = weld_elements(surface);
  CHECK(weld.count == 16);
  for (Index i = 0; i < 8; ++i) {
    CHECK(weld.place[i] == i);
    CHECK(weld.place[8 + i] == 8 + i);
    CHECK(weld.place[16 + i] == i);
  }
}
