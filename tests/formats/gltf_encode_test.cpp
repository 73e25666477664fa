#include <cmath>

#include <catch2/catch.hpp>

#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"
#include "tests/formats/tinygltf_reader.h"

using namespace fairway;
using namespace fairway::test;

namespace {

Bytes encoded(const Document& document, const std::vector<SurfaceResult>& results,
              Format format = Format::glb) {
  auto out = document.encode(results, format);
  if (!out) FAIL(out.error().message);
  return *std::move(out);
}

/// A cube beside everything that must survive: materials, extras, unknown members, an image in the
/// buffer, a camera, an animation; keys in an unusual order.
SampleGlb rich_sample() {
  SampleGlb sample = cube_sample();
  Json& json = sample.json;
  const std::size_t image = sample.add_view(text_bytes("not really a PNG"));
  json["images"] = Json::array({{{"mimeType", "image/png"}, {"bufferView", image}}});
  json["zebra"] = {{"first", 1.0}, {"a", {1, 2.5, "\u00e4\u0001"}}, {"big", 9007199254740993}};
  json["extras"] = {{"z", nullptr}, {"a", true}, {"tiny", 1e-300}};
  json["extensionsUsed"] = {"VENDOR_thing"};
  json["nodes"][0]["extensions"] = {{"VENDOR_thing", {{"accessor", 0}}}};
  json["materials"] = Json::array({{{"name", "red"}}});
  json["meshes"][0]["primitives"][0]["material"] = 0;
  json["meshes"][0]["extras"] = {{"keep", "me"}};
  return sample;
}

std::size_t index_at(const SampleGlb& sample, const char* pointer) {
  return sample.json.at(Json::json_pointer(pointer)).get<std::size_t>();
}

constexpr const char* kPosition = "/meshes/0/primitives/0/attributes/POSITION";

}  // namespace

TEST_CASE("a document without any buffer view gets its attributes") {
  SampleGlb sample = empty_sample();
  sample.json["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}}}));
  const Decoded document = decoded(sample.glb());
  auto results = shifted(*document, Vec3(1, 2, 3));
  for (int i = 0; i < 4; ++i) add_ramp(*document, "_RAMP" + std::to_string(i), 1, results);
  const auto bytes = document->encode(results, Format::glb);
  REQUIRE(bytes);
  SampleGlb after = parse_sample(*bytes);
  after.bin = data_uri_bytes(after.json["buffers"][0]["uri"]);
  const Json& attributes = after.json["meshes"][0]["primitives"][0]["attributes"];
  REQUIRE(attributes["POSITION"] != 0);
  CHECK(floats_of(after, attributes["POSITION"])[4] == 2.0F);
  for (int i = 0; i < 4; ++i) {
    CHECK(floats_of(after, attributes["_RAMP" + std::to_string(i)])[2] == 2.0F);
  }
}

TEST_CASE("encoder changes nothing but the keys it must") {
  const SampleGlb before = rich_sample();
  const auto document = decoded(before.glb());
  auto results = shifted(*document, Vec3(0.5, 0, 0));
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  SampleGlb after = parse_sample(encoded(*document, results));

  REQUIRE(after.bin.size() > before.bin.size());
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(before.bin.size())) == before.bin);
  CHECK(index_at(after, kPosition) == before.json["accessors"].size());
  CHECK(after.json["buffers"][0]["byteLength"] == after.bin.size());
  // Taken back, the patched document is the old one, key order included.
  after.json["buffers"] = before.json["buffers"];
  for (const char* list : {"accessors", "bufferViews"}) {
    REQUIRE(after.json[list].size() == before.json[list].size() + 2);
    after.json[list].erase(after.json[list].size() - 1);
    after.json[list].erase(after.json[list].size() - 1);
  }
  Json& attributes = after.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["POSITION"] = 0;
  attributes.erase("_CURVATURE_MEAN");
  CHECK(after.json.dump() == before.json.dump());
}

TEST_CASE("encoder writes the positions it is given, with their bounds, aligned") {
  const auto document = decoded(cube_sample().glb());
  auto results = shifted(*document, Vec3(0.1, -0.2, 0.3));
  add_ramp(*document, "_CURVATURE_DIR1", 3, results);
  const SampleGlb after = parse_sample(encoded(*document, results));
  const std::size_t position = index_at(after, kPosition);
  const auto values = floats_of(after, position);
  for (std::size_t i = 0; i < 8; ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      CHECK(values[3 * i + static_cast<std::size_t>(c)] ==
            static_cast<float>(results[0].positions[i][c]));
    }
  }
  const Json& accessor = after.json["accessors"][position];
  for (std::size_t c = 0; c < 3; ++c) {
    float low = values[c];
    float high = values[c];
    for (std::size_t i = c; i < values.size(); i += 3) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    CHECK(accessor["min"][c].get<double>() == static_cast<double>(low));
    CHECK(accessor["max"][c].get<double>() == static_cast<double>(high));
  }
  for (const Json& view : after.json["bufferViews"]) CHECK(view["byteOffset"].get<int>() % 4 == 0);
  CHECK(after.json["bufferViews"].back()["target"] == 34962);
}

TEST_CASE("tinygltf reads what the encoder wrote") {
  const auto document = decoded(cube_sample().glb());
  auto results = shifted(*document, Vec3(1, 0, 0));
  add_ramp(*document, "_CURVATURE_K1", 1, results);
  for (const Format format : {Format::glb, Format::gltf}) {
    const OtherReading reading = read_with_tinygltf(encoded(*document, results, format), format);
    INFO(reading.problem);
    REQUIRE(reading.loaded);
    CHECK(reading.generator == "sample");
    REQUIRE(reading.attributes.count("POSITION") == 1);
    CHECK(reading.attributes.at("POSITION")[18] == 2.0F);
    CHECK(reading.attributes.at("_CURVATURE_K1") == results[0].attributes[0].values);
    CHECK(reading.indices == cube_indices());
  }
}

TEST_CASE("a surface that did not move keeps its positions and normals") {
  SampleGlb sample = cube_sample();
  const std::size_t normal =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, 1}));
  sample.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normal;
  const auto document = decoded(sample.glb());
  const SampleGlb same = parse_sample(encoded(*document, unmoved(*document)));
  CHECK(same.json.dump() == sample.json.dump());
  CHECK(same.bin == sample.bin);
  auto results = unmoved(*document);
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  const SampleGlb after = parse_sample(encoded(*document, results));
  CHECK(index_at(after, kPosition) == 0);
  CHECK(index_at(after, "/meshes/0/primitives/0/attributes/NORMAL") == normal);
  CHECK(after.json["accessors"].size() == sample.json["accessors"].size() + 1);
}

TEST_CASE("feature flags are floats of 0 and 1 that every reader takes, positions untouched") {
  const SampleGlb sample = cube_sample();
  const auto document = decoded(sample.glb());
  auto results = unmoved(*document);
  const std::vector<float> flags = {0, 1, 1, 0, 0, 0, 1, 0};
  results[0].attributes.push_back({"_FEATURE", 1, flags});
  const Bytes out = encoded(*document, results);
  const OtherReading reading = read_with_tinygltf(out, Format::glb);
  INFO(reading.problem);
  REQUIRE(reading.loaded);
  CHECK(reading.attributes.at("_FEATURE") == flags);
  const SampleGlb after = parse_sample(out);
  const Json& accessor =
      after.json["accessors"][index_at(after, "/meshes/0/primitives/0/attributes/_FEATURE")];
  CHECK(accessor["componentType"] == 5126);
  CHECK(accessor["type"] == "SCALAR");
  CHECK(index_at(after, kPosition) == 0);
  CHECK(after.json["accessors"][0].dump() == sample.json["accessors"][0].dump());
}

TEST_CASE("shared positions are de-shared, never written in place") {
  SampleGlb sample = cube_sample();
  Json& first = sample.json["meshes"][0]["primitives"];
  first.push_back(first[0]);
  first.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}));
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}, {"mode", 1}}}));
  const auto document = decoded(sample.glb());
  REQUIRE(document->surfaces().size() == 2);
  auto results = shifted(*document, Vec3(1, 0, 0));
  results[1].moved = false;
  const SampleGlb after = parse_sample(encoded(*document, results));
  const std::size_t moved = index_at(after, kPosition);
  CHECK(moved != 0);
  CHECK(index_at(after, "/meshes/0/primitives/1/attributes/POSITION") == moved);
  CHECK(index_at(after, "/meshes/0/primitives/2/attributes/POSITION") == 0);
  CHECK(index_at(after, "/meshes/1/primitives/0/attributes/POSITION") == 0);
  CHECK(index_at(after, "/meshes/2/primitives/0/attributes/POSITION") == 0);
  CHECK(floats_of(after, 0) == floats_of(sample, 0));
}

TEST_CASE("primitives that share positions but not normals keep their own normals") {
  SampleGlb sample = cube_sample();
  const std::size_t up =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, 1}));
  const std::size_t down =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, -1}));
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives.push_back(primitives[0]);
  primitives[0]["attributes"]["NORMAL"] = up;
  primitives[1]["attributes"]["NORMAL"] = down;
  const auto document = decoded(sample.glb());
  const SampleGlb after = parse_sample(encoded(*document, shifted(*document, Vec3(1, 0, 0))));
  CHECK(floats_of(after, index_at(after, "/meshes/0/primitives/0/attributes/NORMAL"))[2] == 1.0F);
  CHECK(floats_of(after, index_at(after, "/meshes/0/primitives/1/attributes/NORMAL"))[2] == -1.0F);
  CHECK_FALSE(after.json["meshes"][0]["primitives"][2]["attributes"].contains("NORMAL"));
  CHECK(index_at(after, "/meshes/0/primitives/1/attributes/POSITION") ==
        index_at(after, kPosition));
}

TEST_CASE("tangents follow the new normals and keep their handedness") {
  SampleGlb sample = cube_sample();
  Json& attributes = sample.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] =
      sample.add_vec3(std::vector<std::array<float, 3>>(8, std::array<float, 3>{0, 0, 1}));
  std::vector<float> tangents;
  for (int i = 0; i < 8; ++i) {
    tangents.insert(tangents.end(), {1.0F, 0.0F, 0.0F, i % 2 == 0 ? 1.0F : -1.0F});
  }
  const std::size_t old = sample.add_accessor(sample.add_view(bytes_of(tangents)), 5126, "VEC4", 8);
  attributes["TANGENT"] = old;
  const auto document = decoded(sample.glb());
  auto results = shifted(*document, Vec3(0, 0, 0));
  results[0].normals.assign(8, Vec3(0.6, 0.0, 0.8));
  results[0].normals[3] = Vec3(1, 0, 0);  // along the old tangent: any perpendicular will do
  const SampleGlb after = parse_sample(encoded(*document, results));
  const std::size_t now = index_at(after, "/meshes/0/primitives/0/attributes/TANGENT");
  CHECK(now != old);
  const auto values = floats_of(after, now);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 t(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
    CHECK(t.norm() == Approx(1.0));
    CHECK(std::abs(t.dot(results[0].normals[i])) < 1e-6);
    CHECK(values[4 * i + 3] == tangents[4 * i + 3]);
  }
  CHECK(values[0] == Approx(0.8));
}

TEST_CASE("an attribute of the same name is replaced") {
  SampleGlb sample = cube_sample();
  const std::vector<float> old(8, 7.0F);
  sample.json["meshes"][0]["primitives"][0]["attributes"]["_CURVATURE_MEAN"] =
      sample.add_accessor(sample.add_view(bytes_of(old)), 5126, "SCALAR", 8);
  const auto document = decoded(sample.glb());
  auto results = unmoved(*document);
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  const SampleGlb after = parse_sample(encoded(*document, results));
  const char* place = "/meshes/0/primitives/0/attributes/_CURVATURE_MEAN";
  CHECK(floats_of(after, index_at(after, place)) == results[0].attributes[0].values);
  CHECK(floats_of(after, index_at(sample, place)) == old);
}

TEST_CASE("raw integer positions come back as floats in the same range") {
  SampleGlb sample = cube_sample();
  std::vector<std::int16_t> quantized;
  for (const auto& c : cube_corners()) {
    for (const float v : c) quantized.push_back(static_cast<std::int16_t>(v * 1000));
    quantized.push_back(0);
  }
  sample.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      sample.add_accessor(sample.add_view(bytes_of(quantized), 8), 5122, "VEC3", 8);
  sample.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  sample.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto document = decoded(sample.glb());
  const SampleGlb after = parse_sample(encoded(*document, shifted(*document, Vec3(0.25, 0, 0))));
  CHECK(floats_of(after, index_at(after, kPosition))[18] == 1000.25F);
  CHECK(after.json["extensionsRequired"] == sample.json["extensionsRequired"]);
}

TEST_CASE("encoder refuses results that do not fit, and positions that no float holds") {
  const auto document = decoded(cube_sample().glb());
  auto few = shifted(*document, Vec3(0, 0, 0));
  few[0].positions.pop_back();
  CHECK(document->encode(few, Format::glb).error().code == ErrorCode::internal);
  CHECK(document->encode({}, Format::glb).error().code == ErrorCode::internal);
  CHECK(document->encode(shifted(*document, Vec3(1e39, 0, 0)), Format::glb).error().code ==
        ErrorCode::diverged);
  CHECK(document->encode(unmoved(*document), Format::drc).error().code ==
        ErrorCode::unsupported_feature);
}
