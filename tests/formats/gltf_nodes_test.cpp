// The scale at which meshes stand in a scene.

#include "proto/formats/gltf_nodes.h"

#include <catch2/catch.hpp>

#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// Of mesh 0, in a scene of these nodes.
WorldScale scale_in(const std::string& nodes, const std::string& animations = "[]") {
  Json json = {{"nodes", Json::parse(nodes)}, {"meshes", Json::array({Json::object()})}};
  json["animations"] = Json::parse(animations);
  return world_scales(JsonPlace(json, ""), 1).front();
}

void check_scale(const std::string& nodes, double scale) {
  const WorldScale found = scale_in(nodes);
  INFO(nodes);
  CHECK(found.why_none.empty());
  CHECK(found.value == Approx(scale).epsilon(1e-9));
}

}  // namespace

TEST_CASE("scales of a hierarchy multiply, whatever is rotated, moved and mirrored") {
  check_scale(R"([{"mesh":0}])", 1.0);
  check_scale(R"([{"mesh":0,"scale":[2,2,2]}])", 2.0);
  check_scale(R"([{"mesh":0,"scale":[-2,2,2],"translation":[1,2,3]}])", 2.0);
  check_scale(R"([{"scale":[3,3,3],"rotation":[0.6,0,0,0.8],"children":[1]},
                  {"matrix":[0,0.5,0,0, -0.5,0,0,0, 0,0,0.5,0, 7,8,9,1],"children":[2]},
                  {"mesh":0,"scale":[4,4,4]}])",
              6.0);
  // What one node stretches another may take back.
  check_scale(R"([{"scale":[1,2,1],"children":[1]},{"mesh":0,"scale":[2,1,2]}])", 2.0);
  check_scale(R"([{"mesh":0,"scale":[2,2,2]},{"mesh":0,"scale":[2,2,-2]}])", 2.0);
}

TEST_CASE("what has no single uniform scale says why") {
  const auto why = [](const std::string& nodes, const std::string& animations = "[]") {
    return scale_in(nodes, animations).why_none;
  };
  CHECK(why(R"([{}])") == "no node uses it");
  CHECK(why(R"([{"mesh":0,"scale":[1,1,1.001]}])") == "its scale is not uniform");
  CHECK(why(R"([{"scale":[1,1,2],"children":[1]},{"mesh":0,"rotation":[0.6,0,0,0.8]}])") ==
        "its scale is not uniform");
  CHECK(why(R"([{"mesh":0,"scale":[0,0,0]}])") == "it is scaled to nothing");
  CHECK(why(R"([{"mesh":0,"scale":[2,2,2]},{"mesh":0}])") == "its nodes have different scales");
  CHECK(why(R"([{"mesh":0,"scale":[2,2,2]},{"mesh":0,"skin":0}])") == "it is skinned");
  CHECK(
      why(R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"SCALE":1}}}}])") ==
      "its instances are scaled");
  const std::string nodes = R"([{"children":[1]},{"mesh":0}])";
  CHECK(why(nodes, R"([{"channels":[{"target":{"node":0,"path":"scale"}}]}])") ==
        "its scale is animated");
  CHECK(why(nodes, R"([{"channels":[{"target":{"node":0,"path":"rotation"}}]}])").empty());
  const auto pointer = [&](const std::string& text) {
    return why(nodes, R"([{"channels":[{"target":{"path":"pointer","extensions":
        {"KHR_animation_pointer":{"pointer":")" +
                          text + R"("}}}}]}])");
  };
  CHECK(pointer("/nodes/1/scale") == "its scale is animated");
  CHECK(pointer("/nodes/1/translation").empty());
  CHECK(pointer("/nodes/scale").empty());
  CHECK(pointer("/nodes/9/scale").empty());
}

TEST_CASE("animations that are none are no trouble") {
  for (const char* text : {"3", "[3]", R"([{"channels":7}])", R"([{"channels":[{"target":1}]}])",
                           R"([{"channels":[{"target":{"path":2}}]}])",
                           R"([{"channels":[{"target":{"path":"scale","node":-1}}]}])"}) {
    CHECK(scale_in(R"([{"mesh":0}])", text).why_none.empty());
  }
}

TEST_CASE("a deep hierarchy is walked without recursion") {
  Json nodes = Json::array();
  for (std::size_t i = 0; i < 1000; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes[0]["scale"] = {2, 2, 2};
  nodes.push_back({{"mesh", 0}});
  check_scale(nodes.dump(), 2.0);
}

TEST_CASE("surfaces of a document know their scale") {
  SampleGlb sample = cube_sample();
  CHECK(decoded(sample.glb())->surfaces()[0].world_scale.value == 1.0);
  sample.json["nodes"][0]["scale"] = {3, 3, 3};
  CHECK(decoded(sample.glb())->surfaces()[0].world_scale.value == Approx(3.0));
}
