// "compression": glTF primitives that are compressed on request.

#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "proto/formats/document.h"
#include "proto/formats/draco_decoder.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/meshopt_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";

SampleGlb compressed(const Document& document, const std::vector<SurfaceResult>& results,
                     Compression compression, DracoOptions options = {}) {
  const auto out = document.write(results, Format::glb, {compression, options});
  if (!out) FAIL(out.error().message);
  return parse_sample(out->bytes.joined());
}

std::vector<SurfaceResult> moved_with_curvature(const Document& document) {
  auto results = shifted(document, Vec3(1, 0, 0));
  add_ramp(document, "_CURVATURE_MEAN", 1, results);
  return results;
}

Json& primitive_of(SampleGlb& sample, std::size_t i = 0) {
  return sample.json["meshes"][0]["primitives"][i];
}

bool lists(const Json& root, const char* name) {
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    if (!root.contains(key)) return false;
    if (std::count(root[key].begin(), root[key].end(), name) != 1) return false;
  }
  return true;
}

/// The stream of a Draco primitive.
DracoMesh stream_of(SampleGlb& sample, std::size_t primitive = 0) {
  const Json& extension = primitive_of(sample, primitive)["extensions"][kDraco];
  const Json& view = sample.json["bufferViews"][extension["bufferView"].get<std::size_t>()];
  auto mesh = DracoMesh::decode(
      std::span(sample.bin)
          .subspan(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>()));
  REQUIRE(mesh);
  return *std::move(mesh);
}

std::vector<double> draco_attribute(SampleGlb& sample, const char* name) {
  const DracoMesh mesh = stream_of(sample);
  const Json& ids = primitive_of(sample)["extensions"][kDraco]["attributes"];
  const DracoAttribute* found = mesh.find_unique(ids.at(name).get<std::uint64_t>());
  REQUIRE(found != nullptr);
  return *mesh.values(*found);
}

}  // namespace

TEST_CASE("a plain primitive becomes a Draco primitive, and reads back") {
  const SampleGlb before = cube_sample();
  const auto document = decoded(before.glb());
  SampleGlb after = compressed(*document, moved_with_curvature(*document), Compression::draco);
  CHECK(lists(after.json, kDraco));
  const Json& primitive = primitive_of(after);
  CHECK(primitive["extensions"][kDraco]["attributes"].size() == 2);
  for (const auto& item : primitive["attributes"].items()) {
    const Json& label = after.json["accessors"][item.value().get<std::size_t>()];
    CHECK_FALSE(label.contains("bufferView"));
    CHECK(label["count"] == 8);
    CHECK(label.contains("min") == (item.key() == "POSITION"));
  }
  // What was there stays: accessors, views, and the bytes they name.
  for (const char* key : {"accessors", "bufferViews"}) {
    for (std::size_t i = 0; i < before.json[key].size(); ++i) {
      CHECK(after.json[key][i].dump() == before.json[key][i].dump());
    }
  }
  CHECK(std::equal(before.bin.begin(), before.bin.end(), after.bin.begin()));
  const auto again = decoded(after.glb());
  CHECK(again->surfaces()[0].mesh.triangles == document->surfaces()[0].mesh.triangles);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 expected = document->surfaces()[0].mesh.positions[i] + Vec3(1, 0, 0);
    CHECK((again->surfaces()[0].mesh.positions[i] - expected).norm() < 1e-3);
  }
  const auto mean = draco_attribute(after, "_CURVATURE_MEAN");
  for (std::size_t i = 0; i < 8; ++i) CHECK(mean[i] == Approx(i).margin(1e-4));
}

TEST_CASE("copies of a vertex stay equal in two Draco primitives") {
  SampleGlb sample = cube_sample();
  // The upper half again, a thousandth wider, with vertices of its own: other bounds.
  auto corners = cube_corners();
  const std::size_t positions = sample.add_vec3({corners[0], corners[1], corners[2], {0, 3, 0.3F}});
  const std::size_t indices = sample.add_indices({0, 1, 2, 0, 2, 3});
  sample.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const auto document = decoded(sample.glb());
  auto results = shifted(*document, Vec3(0.123, 0.456, 0.789));
  DracoOptions options;
  options.position_bits = 9;
  SampleGlb after = compressed(*document, results, Compression::draco, options);
  const auto first = *stream_of(after, 0).values(*stream_of(after, 0).find(DracoKind::position));
  const auto second = *stream_of(after, 1).values(*stream_of(after, 1).find(DracoKind::position));
  for (std::size_t i = 0; i < 9; ++i) CHECK(first[i] == second[i]);
}

TEST_CASE("what stands beside a Draco stream keeps its order") {
  SampleGlb sample = cube_sample();
  const std::size_t extra = sample.add_vec3(cube_corners());
  primitive_of(sample)["attributes"]["_OTHER"] = extra;
  primitive_of(sample)["targets"] = {{{"POSITION", extra}}};
  const auto document = decoded(sample.glb());
  DracoOptions options;
  options.keep_order = false;
  // Morph targets name vertices: the order is kept although it need not be.
  SampleGlb after = compressed(*document, unmoved(*document), Compression::draco, options);
  CHECK(primitive_of(after)["attributes"]["_OTHER"] == extra);
  CHECK_FALSE(primitive_of(after)["extensions"][kDraco]["attributes"].contains("_OTHER"));
  CHECK(stream_of(after).triangles() == document->surfaces()[0].mesh.triangles);
  // Without them all goes into the stream.
  primitive_of(sample).erase("targets");
  const auto free = decoded(sample.glb());
  SampleGlb reordered = compressed(*free, unmoved(*free), Compression::draco, options);
  const auto position = draco_attribute(reordered, "POSITION");
  const auto other = draco_attribute(reordered, "_OTHER");
  for (std::size_t i = 0; i < 24; ++i) CHECK(other[i] == Approx(position[i]).margin(1e-3));
}

TEST_CASE("what a Draco stream would change or repeat stays plain, and a note says so") {
  SampleGlb sample = cube_sample();
  std::size_t count = 1;
  SECTION("shared vertices") {
    sample.json["meshes"][0]["primitives"].push_back(primitive_of(sample));
    count = 2;
  }
  SECTION("a strip") {
    primitive_of(sample)["mode"] = 5;
  }
  SECTION("a fan") {
    primitive_of(sample)["mode"] = 6;
  }
  SECTION("no indices") {
    primitive_of(sample).erase("indices");
    primitive_of(sample)["attributes"]["POSITION"] =
        sample.add_vec3({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  }
  const auto document = decoded(sample.glb());
  const auto out =
      document->write(shifted(*document, Vec3(1, 0, 0)), Format::glb, {Compression::draco, {}});
  REQUIRE(out);
  REQUIRE(out->notes.size() == 1);
  CHECK(out->notes[0].find(fmt::format("{} primitives are not compressed", count)) !=
        std::string::npos);
  CHECK_FALSE(parse_sample(out->bytes.joined()).json.contains("extensionsUsed"));
}

TEST_CASE("keep: each primitive comes back as it came") {
  SECTION("plain") {
    const auto document = decoded(cube_sample().glb());
    const auto results = moved_with_curvature(*document);
    CHECK(document->write(results, Format::glb, {Compression::keep, {}})->bytes.joined() ==
          *document->encode(results, Format::glb));
  }
  SECTION("Draco that moved") {
    const auto document = decoded(draco_glb({true, true, true, true}).glb());
    SampleGlb after = compressed(*document, moved_with_curvature(*document), Compression::keep);
    CHECK(lists(after.json, kDraco));
    const Json& ids = primitive_of(after)["extensions"][kDraco]["attributes"];
    for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0", "_CURVATURE_MEAN"}) {
      CHECK(ids.contains(name));
    }
    CHECK(decoded(after.glb())->surfaces()[0].mesh.triangles ==
          document->surfaces()[0].mesh.triangles);
  }
  SECTION("Draco that did not move keeps its stream") {
    const SampleGlb before = draco_glb({true, true, false, false});
    const auto document = decoded(before.glb());
    auto results = unmoved(*document);
    add_ramp(*document, "_CURVATURE_MEAN", 1, results);
    SampleGlb after = compressed(*document, results, Compression::keep);
    CHECK(primitive_of(after)["extensions"].dump() ==
          before.json["meshes"][0]["primitives"][0]["extensions"].dump());
    CHECK(after.json["accessors"].size() == before.json["accessors"].size() + 1);
    const auto again = decoded(after.glb());
    CHECK(again->surfaces()[0].mesh.positions == document->surfaces()[0].mesh.positions);
  }
  SECTION("meshopt") {
    for (const char* extension : {kMeshopt, "KHR_meshopt_compression"}) {
      const auto document = decoded(meshopt_cube(extension).glb());
      SampleGlb after = compressed(*document, moved_with_curvature(*document), Compression::keep);
      CHECK(lists(after.json, extension));
      CHECK(after.json["bufferViews"].back()["extensions"].contains(extension));
      CHECK(after.json["extensionsUsed"].size() == 1);
    }
  }
}

TEST_CASE("attributes that replace those of a stream that stays leave it") {
  const auto plain = decoded(cube_sample().glb());
  const SampleGlb before = compressed(*plain, moved_with_curvature(*plain), Compression::draco);
  const auto document = decoded(before.glb());
  auto results = unmoved(*document);
  results[0].attributes.push_back({"_CURVATURE_MEAN", 1, std::vector<float>(8, 4.0F)});
  SampleGlb after = compressed(*document, results, Compression::keep);
  CHECK_FALSE(primitive_of(after)["extensions"][kDraco]["attributes"].contains("_CURVATURE_MEAN"));
  const auto accessor = primitive_of(after)["attributes"]["_CURVATURE_MEAN"].get<std::size_t>();
  CHECK(floats_of(after, accessor) == std::vector<float>(8, 4.0F));
}

TEST_CASE("meshopt views hold the same floats and indices, with a fallback buffer") {
  for (const bool from_draco : {false, true}) {
    const SampleGlb before = from_draco ? draco_glb({false, true, false, true}) : cube_sample();
    const auto document = decoded(before.glb());
    const auto results = moved_with_curvature(*document);
    for (const Format format : {Format::glb, Format::gltf}) {
      const auto plain = decoded(*document->encode(results, format), format);
      const auto out = document->write(results, format, {Compression::meshopt, {}});
      REQUIRE(out);
      const auto again = decoded(out->bytes.joined(), format);
      CHECK(again->surfaces()[0].mesh.positions == plain->surfaces()[0].mesh.positions);
      CHECK(again->surfaces()[0].normals == plain->surfaces()[0].normals);
      CHECK(again->surfaces()[0].mesh.triangles == plain->surfaces()[0].mesh.triangles);
    }
    SampleGlb after = compressed(*document, results, Compression::meshopt);
    CHECK(lists(after.json, kMeshopt));
    CHECK_FALSE(primitive_of(after).contains("extensions"));
    const Json& fallback = after.json["buffers"].back();
    CHECK(fallback["extensions"][kMeshopt]["fallback"] == true);
    CHECK_FALSE(fallback.contains("uri"));
    std::size_t end = 0;
    for (const Json& view : after.json["bufferViews"]) {
      if (!view.contains("extensions")) continue;
      CHECK(view["buffer"] == after.json["buffers"].size() - 1);
      CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
      end = view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>();
      CHECK(view["extensions"][kMeshopt]["buffer"] == 0);
    }
    CHECK(fallback["byteLength"] == end);
  }
}
