// Numbers in a glTF that lie: each is refused before it is believed.

#include <optional>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "proto/formats/document.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/formats/gltf_scene.h"
#include "proto/formats/gltf_text.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// A cube with one value changed at a JSON pointer.
Error refusal_with(const char* pointer, const Json& value) {
  SampleGlb sample = cube_sample();
  sample.json[Json::json_pointer(pointer)] = value;
  CAPTURE(pointer, value.dump());
  const auto document = decode(sample.glb(), Format::glb);
  REQUIRE_FALSE(document);
  return document.error();
}

SampleGlb chain(std::size_t length) {
  SampleGlb sample = cube_sample();
  sample.json["nodes"] = Json::array();
  for (std::size_t i = 0; i < length; ++i) {
    Json node = {{"mesh", 0}};
    if (i + 1 < length) node["children"] = {i + 1};
    sample.json["nodes"].push_back(node);
  }
  return sample;
}

}  // namespace

TEST_CASE("decoder refuses counts and offsets that leave the bytes") {
  for (const Json& value :
       {Json(9), Json(0), Json(-8), Json(4000000000U), Json(9007199254740991U),
        Json(18446744073709551615U), Json(1e300), Json(8.5), Json("8"), Json(nullptr)}) {
    CHECK(refusal_with("/accessors/0/count", value).code == ErrorCode::invalid_mesh);
  }
  for (const char* pointer : {"/accessors/0/byteOffset", "/bufferViews/0/byteOffset",
                              "/bufferViews/1/byteLength", "/buffers/0/byteLength"}) {
    for (const Json& value : {Json(-4), Json(4000000000U), Json(18446744073709551612U)}) {
      CHECK(refusal_with(pointer, value).code == ErrorCode::invalid_mesh);
    }
  }
  for (const Json& value : {Json(0), Json(4), Json(2147483647), Json(256)}) {
    CHECK(refusal_with("/bufferViews/0/byteStride", value).code == ErrorCode::invalid_mesh);
  }
}

TEST_CASE("decoder refuses references to what is not there") {
  for (const char* pointer :
       {"/meshes/0/primitives/0/indices", "/meshes/0/primitives/0/attributes/POSITION",
        "/accessors/0/bufferView", "/bufferViews/0/buffer", "/scene", "/scenes/0/nodes/0",
        "/nodes/0/mesh", "/nodes/0/skin"}) {
    CHECK(refusal_with(pointer, 99).code == ErrorCode::invalid_mesh);
    CHECK(refusal_with(pointer, -1).code == ErrorCode::invalid_mesh);
    CHECK(refusal_with(pointer, "0").code == ErrorCode::invalid_mesh);
  }
}

TEST_CASE("decoder refuses accessors of the wrong shape") {
  CHECK(refusal_with("/accessors/0/type", "VEC2").code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/accessors/0/type", "VEC9").code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/accessors/0/componentType", 9999).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/accessors/0/componentType", 5121).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/accessors/1/componentType", 5126).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/accessors/1/count", 35).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/meshes/0/primitives/0/mode", 99).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/meshes/0/primitives", Json::array()).code == ErrorCode::invalid_mesh);
}

TEST_CASE("an accessor without bytes cannot claim billions of vertices") {
  SampleGlb sample = cube_sample();
  sample.json["accessors"][0].erase("bufferView");
  sample.json["accessors"][0]["count"] = 4000000000U;
  const auto document = decode(sample.glb(), Format::glb);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::invalid_mesh);
}

TEST_CASE("decoder refuses sparse parts that leave their bytes") {
  const Json good = {{"count", 1},
                     {"indices", {{"bufferView", 1}, {"componentType", 5125}}},
                     {"values", {{"bufferView", 0}}}};
  SampleGlb sample = cube_sample();
  sample.json["accessors"][0]["sparse"] = good;
  REQUIRE(decode(sample.glb(), Format::glb));
  for (const char* pointer : {"/count", "/indices/bufferView", "/indices/byteOffset",
                              "/values/bufferView", "/values/byteOffset"}) {
    Json sparse = good;
    sparse[Json::json_pointer(pointer)] = 4000000000U;
    CHECK(refusal_with("/accessors/0/sparse", sparse).code == ErrorCode::invalid_mesh);
  }
  Json sparse = good;
  sparse["indices"]["bufferView"] = 0;  // -1.0f as an index
  CHECK(refusal_with("/accessors/0/sparse", sparse).code == ErrorCode::invalid_mesh);
}

TEST_CASE("decoder refuses a document that is no glTF 2") {
  CHECK(refusal_with("/asset", Json::object()).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/asset/version", 2).code == ErrorCode::invalid_mesh);
  CHECK(refusal_with("/asset/version", "1.0").code == ErrorCode::unsupported_format);
  for (const char* text : {"{}", "[]", "1"}) {
    const auto document = decode(text_bytes(text), Format::gltf);
    REQUIRE_FALSE(document);
    CHECK(document.error().code == ErrorCode::invalid_mesh);
  }
  for (const char* text : {"", " ", "{", "{\"asset\":{},}", "nul"}) {
    const auto document = decode(text_bytes(text), Format::gltf);
    REQUIRE_FALSE(document);
    CHECK(document.error().code == ErrorCode::malformed_input);
  }
}

TEST_CASE("decoder refuses node graphs that are no forest of sane depth") {
  CHECK(refusal_with("/nodes/0/children", {0}).code == ErrorCode::invalid_mesh);
  CHECK(decode(chain(kMaxNodeDepth).glb(), Format::glb));
  CHECK_FALSE(decode(chain(kMaxNodeDepth + 1).glb(), Format::glb));
  CHECK_FALSE(decode(chain(20000).glb(), Format::glb));
  SampleGlb ring = chain(5);
  ring.json["nodes"][4]["children"] = {1};
  CHECK_FALSE(decode(ring.glb(), Format::glb));
  SampleGlb shared = chain(3);
  shared.json["nodes"][0]["children"] = {1, 2};  // which is a child of 1 already
  CHECK_FALSE(decode(shared.glb(), Format::glb));
  ring.json["nodes"][4]["children"] = {0};
  CHECK_FALSE(decode(ring.glb(), Format::glb));
}

TEST_CASE("decoder refuses transforms that no float holds") {
  CHECK(refusal_with("/nodes/0/matrix", std::vector<double>(16, 1e39)).code ==
        ErrorCode::invalid_mesh);
  CHECK(refusal_with("/nodes/0/scale", {1, 1}).code == ErrorCode::invalid_mesh);
  SampleGlb flat = cube_sample();
  flat.json["nodes"][0]["scale"] = {0, 0, 0};
  CHECK(decode(flat.glb(), Format::glb));
}

TEST_CASE("a small file cannot make a large mesh by repeating itself") {
  SampleGlb repeated = cube_sample();
  const Json primitive = repeated.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 64; ++i) repeated.json["meshes"][0]["primitives"].push_back(primitive);
  CHECK(decode(repeated.glb(), Format::glb));
  repeated.json["meshes"][0]["primitives"].push_back(primitive);
  CHECK_FALSE(decode(repeated.glb(), Format::glb));

  // Many meshes over one large list of positions.
  SampleGlb shared = cube_sample();
  const std::size_t large =
      shared.add_vec3(std::vector<std::array<float, 3>>(50000, std::array<float, 3>{1, 2, 3}));
  for (int i = 0; i < 1000; ++i) {
    shared.add_mesh(Json::array({{{"attributes", {{"POSITION", large}}}, {"indices", 1}}}));
  }
  const auto document = decode(shared.glb(), Format::glb);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::invalid_mesh);
}

TEST_CASE("views that share their Draco data are not decoded without end") {
  SampleGlb sample = draco_glb();
  const auto use = [](Json& primitive) -> Json& {
    return primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"];
  };
  Json primitive = sample.json["meshes"][0]["primitives"][0];
  const Json view = sample.json["bufferViews"][use(primitive).get<std::size_t>()];
  const auto add_mesh = [&] {
    use(primitive) = sample.json["bufferViews"].size();
    sample.json["bufferViews"].push_back(view);
    sample.add_mesh(Json::array({primitive}));
  };
  for (int i = 0; i < 5; ++i) add_mesh();
  CHECK(decode(sample.glb(), Format::glb));
  // A view costs less JSON than it has Draco data: that grows, and is the same each time.
  sample.bin.resize(sample.bin.size() + 100000);
  sample.json["buffers"][0]["byteLength"] = sample.bin.size();
  const Json large = {{"buffer", 0},
                      {"byteOffset", view.value("byteOffset", 0)},
                      {"byteLength", sample.bin.size() - view.value("byteOffset", 0U)}};
  for (int i = 0; i < 20; ++i) {
    use(primitive) = sample.json["bufferViews"].size();
    sample.json["bufferViews"].push_back(large);
    sample.add_mesh(Json::array({primitive}));
  }
  const auto document = decode(sample.glb(), Format::glb);
  REQUIRE_FALSE(document);
  CHECK(document.error().message.find("share their bytes too often") != std::string::npos);
}

TEST_CASE("a primitive with a thousand attributes is refused before they are looked up") {
  Json many = Json::object();
  for (int i = 0; i < 1000; ++i) many["_A" + std::to_string(i)] = 0;
  for (const char* key : {"attributes", "targets"}) {
    SampleGlb sample = cube_sample();
    Json& primitive = sample.json["meshes"][0]["primitives"][0];
    if (key == std::string("targets")) {
      primitive["targets"] = Json::array({many});
    } else {
      primitive["attributes"].update(many);
    }
    const auto document = decode(sample.glb(), Format::glb);
    REQUIRE_FALSE(document);
    CHECK(document.error().message.find("attributes are stated") != std::string::npos);
  }
  SampleGlb draco = draco_glb();
  draco.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
      .update(many);
  CHECK_FALSE(decode(draco.glb(), Format::glb));
}

TEST_CASE("JSON beyond 4 MiB is refused, payloads of data URIs not counted") {
  SampleGlb sample = cube_sample();
  sample.json["extras"] = std::string(kMaxGltfText, 'x');
  const auto document = decode(sample.glb(), Format::glb);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::too_large);
  sample.json["extras"] = "data:" + std::string(kMaxGltfText, 'x');
  CHECK(decode(sample.glb(), Format::glb));
  // Many short ones are document, not payload.
  sample.json["extras"] = Json(std::vector<std::string>(100000, "data:" + std::string(50, 'x')));
  CHECK_FALSE(decode(sample.glb(), Format::glb));
}

TEST_CASE("payloads are told from document by the text alone") {
  const std::string payload = "data:" + std::string(1000, 'A');
  const auto size_of_list = [](const std::string& text) {
    return size_without_payloads("[\"" + text + "\",1]");
  };
  CHECK(size_of_list(payload) == kUriHead + 6);
  CHECK(size_of_list("x" + payload) == 1006 + 6);
  CHECK(size_of_list("data:\\\"" + std::string(1000, 'A')) == kUriHead + 6);
  CHECK(size_of_list("data:" + std::string(1000, 'A') + "\\\\") == kUriHead + 6);
  CHECK(size_without_payloads("\"" + payload) == kUriHead + 1);
  CHECK(size_without_payloads("\"" + payload + "\\") == kUriHead + 1);
  CHECK(size_without_payloads("") == 0);
}

TEST_CASE("a mesh that collapses in single precision is refused, however many vertices it has") {
  const auto code_at = [](double away, Index n) -> std::optional<ErrorCode> {
    Surface surface;
    surface.mesh = torus(2 * n, n, 1.0, 0.4);
    for (Vec3& p : surface.mesh.positions) p.x() += away;
    const auto file = write_fresh_mesh(surface, {}, Format::glb, {});
    REQUIRE(file);
    const auto document = decode(file->bytes.joined(), Format::glb);
    return document ? std::optional<ErrorCode>() : document.error().code;
  };
  for (const Index n : {8U, 40U}) {
    CHECK(code_at(1e4, n) == std::nullopt);
    CHECK(code_at(5e6, n) == ErrorCode::invalid_mesh);
  }
}
