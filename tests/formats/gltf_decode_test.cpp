#include <cstring>
#include <limits>

#include <catch2/catch.hpp>

#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

Error refusal(const SampleGlb& sample) {
  const auto document = decode(sample.glb(), Format::glb);
  REQUIRE_FALSE(document);
  return document.error();
}

Json& first_primitive(SampleGlb& sample) {
  return sample.json["meshes"][0]["primitives"][0];
}

}  // namespace

TEST_CASE("decoder gives the vertices and triangles of a cube") {
  const auto document = decoded(cube_sample().glb());
  REQUIRE(document->surfaces().size() == 1);
  const Surface& surface = document->surfaces()[0];
  CHECK(surface.name == "meshes/0");
  CHECK(surface.normals.empty());
  REQUIRE(surface.mesh.positions.size() == 8);
  CHECK(surface.mesh.positions[6] == Vec3(1, 1, 1));
  REQUIRE(surface.mesh.triangles.size() == 12);
  CHECK(surface.mesh.triangles[1] == Triangle{0, 3, 2});
  CHECK(document->notes().empty());
}

TEST_CASE("decoder reads self-contained glTF with a byte order mark") {
  const Bytes text = cube_sample().gltf();
  CHECK(decoded(text, Format::gltf)->surfaces()[0].mesh.triangles.size() == 12);
  Bytes marked = text_bytes("\xEF\xBB\xBF");
  marked.insert(marked.end(), text.begin(), text.end());
  CHECK(decode(marked, Format::gltf));
}

TEST_CASE("decoder reads indices of every width, and none") {
  SampleGlb sample = cube_sample();
  std::vector<std::uint8_t> small;
  std::vector<std::uint16_t> medium;
  for (const auto i : cube_indices()) {
    small.push_back(static_cast<std::uint8_t>(i));
    medium.push_back(static_cast<std::uint16_t>(i));
  }
  const auto wide = decoded(sample.glb())->surfaces()[0].mesh.triangles;
  first_primitive(sample)["indices"] =
      sample.add_accessor(sample.add_view(bytes_of(small)), 5121, "SCALAR", small.size());
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.triangles == wide);
  first_primitive(sample)["indices"] =
      sample.add_accessor(sample.add_view(bytes_of(medium)), 5123, "SCALAR", medium.size());
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.triangles == wide);

  SampleGlb soup = empty_sample();
  const auto corners = cube_corners();
  const std::size_t position = soup.add_vec3({corners[0], corners[2], corners[1]});
  soup.add_mesh(Json::array({{{"attributes", {{"POSITION", position}}}}}));
  CHECK(decoded(soup.glb())->surfaces()[0].mesh.triangles ==
        std::vector<Triangle>{Triangle{0, 1, 2}});
}

TEST_CASE("decoder turns strips and fans into triangles of one orientation") {
  SampleGlb sample = cube_sample();
  first_primitive(sample)["indices"] = sample.add_indices({0, 1, 2, 3, 4});
  first_primitive(sample)["mode"] = 5;
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.triangles ==
        std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}});
  first_primitive(sample)["mode"] = 6;
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.triangles ==
        std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
}

TEST_CASE("decoder reads interleaved, sparse and quantized positions") {
  SampleGlb sample = cube_sample();
  const auto expected = decoded(sample.glb())->surfaces()[0].mesh.positions;
  Json& attributes = first_primitive(sample)["attributes"];

  std::vector<float> interleaved;
  for (const auto& c : cube_corners()) {
    interleaved.insert(interleaved.end(), {9, c[0], c[1], c[2], 9});
  }
  const std::size_t view = sample.add_view(bytes_of(interleaved), 20);
  attributes["POSITION"] = sample.add_accessor(view, 5126, "VEC3", 8, 4);
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.positions == expected);

  const std::size_t at = sample.add_view(bytes_of(std::vector<std::uint16_t>{2, 7}));
  const std::size_t to = sample.add_view(bytes_of(std::vector<float>{5, 6, 7, 8, 9, 10}));
  attributes["POSITION"] = sample.add_accessor(view, 5126, "VEC3", 8, 4);
  sample.json["accessors"].back()["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", at}, {"componentType", 5123}}},
      {"values", {{"bufferView", to}}}};
  const auto sparse = decoded(sample.glb())->surfaces()[0].mesh.positions;
  CHECK(sparse[2] == Vec3(5, 6, 7));
  CHECK(sparse[7] == Vec3(8, 9, 10));
  CHECK(sparse[6] == expected[6]);

  std::vector<std::int16_t> quantized;
  for (const auto& c : cube_corners()) {
    for (const float v : c) quantized.push_back(static_cast<std::int16_t>(v * 32767));
    quantized.push_back(0);
  }
  const std::size_t integers = sample.add_view(bytes_of(quantized), 8);
  attributes["POSITION"] = sample.add_accessor(integers, 5122, "VEC3", 8);
  sample.json["accessors"].back()["normalized"] = true;
  sample.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.positions == expected);
  sample.json["accessors"].back()["normalized"] = false;
  CHECK(decoded(sample.glb())->surfaces()[0].mesh.positions[6] == Vec3(32767, 32767, 32767));
}

TEST_CASE("undeclared integer positions are read only where their bounds bear them out") {
  SampleGlb sample = empty_sample();
  const std::vector<std::uint8_t> values = {0, 0, 0, 0, 4, 0, 0, 0, 0, 6, 0, 0};
  const std::size_t position =
      sample.add_accessor(sample.add_view(bytes_of(values), 4), 5121, "VEC3", 3);
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", position}}}}}));
  CHECK(refusal(sample).code == ErrorCode::invalid_mesh);
  sample.json["accessors"][0]["min"] = {0, 0, 0};
  sample.json["accessors"][0]["max"] = {4, 6, 0};
  const auto document = decoded(sample.glb());
  CHECK(document->surfaces()[0].mesh.positions[2] == Vec3(0, 6, 0));
  CHECK(document->notes().size() == 1);
  sample.json["accessors"][0]["max"] = {4, 5, 0};
  CHECK(refusal(sample).code == ErrorCode::invalid_mesh);
}

TEST_CASE("decoder joins the primitives of a mesh over their distinct positions") {
  SampleGlb sample = cube_sample();
  const auto corners = cube_corners();
  const std::size_t other = sample.add_vec3({corners[0], corners[1], corners[2]});
  const std::size_t one = sample.add_indices({0, 1, 2});
  sample.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", 0}}}, {"indices", one}});
  sample.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", other}}}, {"indices", one}});
  sample.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", other}}}, {"mode", 0}});
  const auto document = decoded(sample.glb());
  const Surface& surface = document->surfaces().at(0);
  CHECK(surface.mesh.positions.size() == 11);
  REQUIRE(surface.mesh.triangles.size() == 14);
  CHECK(surface.mesh.triangles[12] == Triangle{0, 1, 2});
  CHECK(surface.mesh.triangles[13] == Triangle{8, 9, 10});
  CHECK(document->notes() == std::vector<std::string>{"points and lines stay as they are"});
}

TEST_CASE("decoder names the bind pose of a skin and the deltas of morph targets in its notes") {
  SampleGlb sample = cube_sample();
  sample.json["skins"] = Json::array({{{"joints", {0}}}});
  sample.json["nodes"][0]["skin"] = 0;
  first_primitive(sample)["targets"] = Json::array({{{"POSITION", 0}}});
  CHECK(decoded(sample.glb())->notes().size() == 2);
}

TEST_CASE("decoder refuses an index out of range and points to it") {
  SampleGlb sample = cube_sample();
  auto indices = cube_indices();
  indices[17] = 8;
  first_primitive(sample)["indices"] = sample.add_indices(indices);
  const Error error = refusal(sample);
  CHECK(error.code == ErrorCode::invalid_mesh);
  CHECK(error.pointer == "/meshes/0/primitives/0/indices");
}

TEST_CASE("decoder refuses positions that are not finite") {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    SampleGlb sample = cube_sample();
    std::memcpy(sample.bin.data() + 52, &value, sizeof value);
    CHECK(refusal(sample).code == ErrorCode::invalid_mesh);
  }
}

TEST_CASE("decoder opens no file and no address") {
  for (const char* uri : {"cube.bin", "/etc/hostname", "file:///etc/hostname", "../x.bin",
                          "http://127.0.0.1:1/x", "//host/x", "", "data:text/plain,abc"}) {
    CAPTURE(uri);
    SampleGlb sample = cube_sample();
    sample.json["buffers"][0]["uri"] = uri;
    const Error error = refusal(sample);
    CHECK(error.code == ErrorCode::invalid_mesh);
    CHECK(error.pointer == "/buffers/0/uri");
  }
  SampleGlb image = cube_sample();
  image.json["images"] = Json::array({{{"uri", "/etc/hostname"}}});
  CHECK(decode(image.glb(), Format::glb));
}

TEST_CASE("decoder refuses a required extension that it does not know") {
  SampleGlb sample = cube_sample();
  sample.json["extensionsUsed"] = {"VENDOR_other_geometry"};
  CHECK(decode(sample.glb(), Format::glb));
  sample.json["extensionsRequired"] = {"VENDOR_other_geometry"};
  CHECK(refusal(sample).code == ErrorCode::unsupported_feature);
  sample.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_basisu"};
  CHECK(decode(sample.glb(), Format::glb));
}

TEST_CASE("a triangle primitive that only meshopt holds is an unsupported feature") {
  SampleGlb sample = cube_sample();
  sample.json["buffers"].push_back(
      {{"byteLength", 96}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  sample.json["bufferViews"][0] = {{"buffer", 1}, {"byteLength", 96}};
  CHECK(refusal(sample).code == ErrorCode::unsupported_feature);
}

TEST_CASE("a file without triangles is refused as such") {
  SampleGlb sample = cube_sample();
  for (const int mode : {0, 1, 2, 3}) {
    first_primitive(sample)["mode"] = mode;
    CHECK(refusal(sample).code == ErrorCode::no_triangles);
  }
  sample.json.erase("meshes");
  sample.json["nodes"][0].erase("mesh");
  CHECK(refusal(sample).code == ErrorCode::no_triangles);
}

TEST_CASE("decoder refuses a mesh that single precision cannot hold where it stands") {
  for (const float x : {1e5F, 1e8F}) {
    SampleGlb sample = cube_sample();
    auto corners = cube_corners();
    for (auto& corner : corners) corner[0] += x;
    first_primitive(sample)["attributes"]["POSITION"] = sample.add_vec3(corners);
    if (x < 1e6F) {
      CHECK(decode(sample.glb(), Format::glb));
    } else {
      CHECK(refusal(sample).code == ErrorCode::invalid_mesh);
    }
  }
}
