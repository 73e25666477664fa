// glTF files whose views are compressed with meshopt.

#include <catch2/catch.hpp>

#include "tests/formats/meshopt_samples.h"

namespace fairway::test {
namespace {

Json& compression(SampleGlb& sample, std::size_t view) {
  return sample.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

Error refusal(const SampleGlb& sample) {
  const Bytes glb = sample.glb();
  const auto document = decode(glb, Format::glb);
  REQUIRE_FALSE(document);
  return document.error();
}

}  // namespace

TEST_CASE("a cube in meshopt views has the corners and triangles of the plain one") {
  const auto* extension = GENERATE("EXT_meshopt_compression", "KHR_meshopt_compression");
  const Decoded plain = decoded(cube_sample().glb());
  const Decoded compressed = decoded(meshopt_cube(extension).glb());
  REQUIRE(compressed->surfaces().size() == 1);
  CHECK(compressed->surfaces()[0].mesh.positions == plain->surfaces()[0].mesh.positions);
  CHECK(compressed->surfaces()[0].mesh.triangles.size() == 12);
}

TEST_CASE("moved vertices of a meshopt file are plain, its streams stay byte for byte") {
  const SampleGlb before = meshopt_cube();
  const Decoded document = decoded(before.glb());
  const auto bytes = document->encode(shifted(*document, Vec3(1, 2, 3)), Format::glb);
  REQUIRE(bytes);
  SampleGlb after = parse_sample(*bytes);
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(before.bin.size())) == before.bin);
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    CHECK(after.json[key] == before.json[key]);
  }
  CHECK(after.json["buffers"][1] == before.json["buffers"][1]);
  const Json& primitive = after.json["meshes"][0]["primitives"][0];
  CHECK(primitive["indices"] == before.json["meshes"][0]["primitives"][0]["indices"]);
  const std::vector<float> moved = floats_of(after, primitive["attributes"]["POSITION"]);
  CHECK(moved[0] == 0.0F);
  CHECK(moved[1] == 1.0F);
  CHECK(moved[2] == 2.0F);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(after.json["bufferViews"][i] == before.json["bufferViews"][i]);
  }
  const Decoded again = decoded(*bytes);
  CHECK(again->surfaces()[0].mesh.triangles == document->surfaces()[0].mesh.triangles);
}

TEST_CASE("broken meshopt views are refused where they stand") {
  const auto check = [](const char* key, const Json& value) {
    SampleGlb sample = meshopt_cube();
    compression(sample, 0)[key] = value;
    const Error error = refusal(sample);
    CAPTURE(key, error.message);
    CHECK(error.code == ErrorCode::invalid_mesh);
    CHECK(error.pointer.rfind("/bufferViews/0", 0) == 0);
  };
  check("buffer", 2);
  check("buffer", 1);
  check("byteOffset", 100000);
  check("byteLength", 4);
  check("byteLength", -1);
  check("byteLength", 9007199254740992);
  check("byteStride", 8);
  check("byteStride", 0);
  check("count", 7);
  check("count", 9007199254740992);
  check("mode", "TRIANGLES");
  check("mode", 3);
  check("filter", "QUATERNION");
}

TEST_CASE("an unknown meshopt filter is refused unless the plain bytes are there") {
  SampleGlb sample = meshopt_cube();
  compression(sample, 0)["filter"] = "COLOR";
  CHECK(refusal(sample).code == ErrorCode::unsupported_feature);
  const SampleGlb plain = cube_sample();
  const Bytes text = plain.gltf();
  const Json embedded = Json::parse(reinterpret_cast<const char*>(text.data()),
                                    reinterpret_cast<const char*>(text.data()) + text.size());
  sample.json["buffers"][1]["uri"] = embedded["buffers"][0]["uri"];
  const Decoded document = decoded(sample.glb());
  CHECK(document->surfaces()[0].mesh.positions ==
        decoded(plain.glb())->surfaces()[0].mesh.positions);
}

TEST_CASE("compressed views that nothing is computed with are not decoded") {
  SampleGlb sample = meshopt_cube();
  sample.json["bufferViews"].push_back(sample.json["bufferViews"][0]);
  compression(sample, 2)["mode"] = "SOMETHING_NEW";
  sample.add_accessor(2, 5126, "VEC3", 8);
  sample.json["meshes"][0]["primitives"][0]["attributes"]["_OTHER"] = 2;
  CHECK(decode(sample.glb(), Format::glb));
}

TEST_CASE("views that share one stream are bounded together by the size of the file") {
  SampleGlb sample = meshopt_cube();
  const std::size_t count = 100000;
  const Bytes stream = meshopt_attributes(Bytes(count * 12), 12);
  Json view = {{"buffer", 1}, {"byteLength", count * 12}, {"byteStride", 12}};
  view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", sample.bin.size()},
                                                   {"byteLength", stream.size()},
                                                   {"byteStride", 12},
                                                   {"mode", "ATTRIBUTES"},
                                                   {"count", count}};
  sample.bin.insert(sample.bin.end(), stream.begin(), stream.end());
  sample.json["buffers"][0]["byteLength"] = sample.bin.size();
  sample.json["buffers"][1]["byteLength"] = count * 12;
  const Json first = sample.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 20; ++i) {
    sample.json["bufferViews"].push_back(view);
    Json primitive = first;
    primitive["attributes"]["POSITION"] =
        sample.add_accessor(sample.json["bufferViews"].size() - 1, 5126, "VEC3", count);
    sample.json["meshes"].push_back({{"primitives", Json::array({primitive})}});
  }
  CHECK(refusal(sample).code == ErrorCode::too_large);
}

}  // namespace fairway::test
