// "compression" of a glTF that is made around a mesh without one.

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "proto/formats/draco_decoder.h"
#include "proto/formats/fresh_mesh.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";

Surface noisy() {
  Surface out;
  out.name = "mesh";
  out.mesh = with_normal_noise(sphere(3, 1.0), 0.3, 5);
  for (const Vec3& p : out.mesh.positions) out.normals.push_back(p.normalized());
  return out;
}

SurfaceResult with_curvature(const Surface& surface) {
  SurfaceResult out;
  VertexAttribute k1{"_CURVATURE_K1", 1, {}};
  for (const Vec3& p : surface.mesh.positions) k1.values.push_back(static_cast<float>(p.norm()));
  out.attributes.push_back(k1);
  return out;
}

Encoded written(Format format, Compression compression, DracoOptions options = {}) {
  const Surface surface = noisy();
  auto out = write_fresh_mesh(surface, with_curvature(surface), format, {compression, options});
  if (!out) FAIL(out.error().message);
  return *std::move(out);
}

void check_lists(const Json& root, const char* name) {
  CHECK(root["extensionsUsed"] == Json::array({name}));
  CHECK(root["extensionsRequired"] == Json::array({name}));
}

}  // namespace

TEST_CASE("a fresh glTF with meshopt holds the same values in fewer bytes") {
  const Surface surface = noisy();
  const Encoded plain = written(Format::glb, Compression::none);
  for (const Format format : {Format::glb, Format::gltf}) {
    const Encoded small = written(format, Compression::meshopt);
    CHECK(small.notes.empty());
    CHECK(small.bytes.size() < written(format, Compression::none).bytes.size());
    const auto was = decoded(plain.bytes.joined());
    const auto is = decoded(small.bytes.joined(), format);
    CHECK(is->surfaces()[0].mesh.positions == was->surfaces()[0].mesh.positions);
    CHECK(is->surfaces()[0].mesh.triangles == surface.mesh.triangles);
    CHECK(is->surfaces()[0].normals == was->surfaces()[0].normals);
  }
  SampleGlb sample = parse_sample(written(Format::glb, Compression::meshopt).bytes.joined());
  check_lists(sample.json, kMeshopt);
  for (const Json& view : sample.json["bufferViews"]) {
    CHECK(view["buffer"] == 1);
    CHECK(view["extensions"][kMeshopt]["buffer"] == 0);
  }
  CHECK(sample.json["buffers"][1]["extensions"][kMeshopt]["fallback"] == true);
}

TEST_CASE("a fresh glTF with Draco is off by what its note states, and says its bounds") {
  const Surface surface = noisy();
  const Encoded out = written(Format::glb, Compression::draco);
  REQUIRE(out.notes.size() == 1);
  CHECK(out.notes[0].find("mesh as Draco: POSITION is off by at most") == 0);
  CHECK(out.notes[0].find("; _CURVATURE_K1 is off by at most") != std::string::npos);
  CHECK(out.bytes.size() < written(Format::glb, Compression::meshopt).bytes.size());
  SampleGlb sample = parse_sample(out.bytes.joined());
  check_lists(sample.json, kDraco);
  const auto document = decoded(out.bytes.joined());
  const Surface& found = document->surfaces()[0];
  CHECK(found.mesh.triangles == surface.mesh.triangles);
  REQUIRE(found.mesh.positions.size() == surface.mesh.positions.size());
  Vec3 low = found.mesh.positions[0];
  for (std::size_t i = 0; i < found.mesh.positions.size(); ++i) {
    CHECK((found.mesh.positions[i] - surface.mesh.positions[i]).cwiseAbs().maxCoeff() < 1.5e-4);
    CHECK(found.normals[i].dot(surface.normals[i]) > 0.99999);
    low = low.cwiseMin(found.mesh.positions[i]);
  }
  const Json& primitive = sample.json["meshes"][0]["primitives"][0];
  const auto position = primitive["attributes"]["POSITION"].get<std::size_t>();
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(sample.json["accessors"][position]["min"][c].get<double>() ==
          low[static_cast<Eigen::Index>(c)]);
  }
}

TEST_CASE("curvature of a fresh Draco primitive stands in its stream by its glTF name") {
  SampleGlb sample = parse_sample(written(Format::glb, Compression::draco).bytes.joined());
  const Json& extension = sample.json["meshes"][0]["primitives"][0]["extensions"][kDraco];
  const Json& view = sample.json["bufferViews"][extension["bufferView"].get<std::size_t>()];
  const auto mesh = DracoMesh::decode(
      std::span(sample.bin)
          .subspan(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>()));
  REQUIRE(mesh);
  const auto id = extension["attributes"]["_CURVATURE_K1"].get<std::uint64_t>();
  const auto values = mesh->values(*mesh->find_unique(id));
  const Surface surface = noisy();
  const auto expected = with_curvature(surface).attributes[0].values;
  REQUIRE(values->size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(std::abs((*values)[i] - static_cast<double>(expected[i])) < 1e-5);
  }
}

TEST_CASE("a fresh glTF with reordered Draco says how many vertices there are") {
  DracoOptions options;
  options.keep_order = false;
  const Encoded out = written(Format::gltf, Compression::draco, options);
  CHECK(out.bytes.size() < written(Format::gltf, Compression::draco).bytes.size());
  const auto document = decoded(out.bytes.joined(), Format::gltf);
  CHECK(document->surfaces()[0].mesh.positions.size() == noisy().mesh.positions.size());
  CHECK(document->surfaces()[0].mesh.triangles.size() == noisy().mesh.triangles.size());
}

TEST_CASE("what came as Draco becomes a compressed glTF with all attributes that have a place") {
  const auto document = decoded(draco_cube({false, true, true, true}), Format::drc);
  const auto results = shifted(*document, Vec3(1, 0, 0));
  for (const Compression compression :
       {Compression::draco, Compression::keep, Compression::meshopt}) {
    const auto out = convert(*document, results, {Format::drc, Format::glb, {compression, {}}});
    REQUIRE(out);
    SampleGlb sample = parse_sample(out->bytes.joined());
    check_lists(sample.json, compression == Compression::meshopt ? kMeshopt : kDraco);
    const auto plain = convert(*document, results, {Format::drc, Format::glb, {}});
    SampleGlb expected = parse_sample(plain->bytes.joined());
    const Json& is = sample.json["meshes"][0]["primitives"][0]["attributes"];
    const Json& was = expected.json["meshes"][0]["primitives"][0]["attributes"];
    CHECK(is.size() == was.size());
    for (const auto& item : was.items()) {
      REQUIRE(is.contains(item.key()));
      const Json& one = sample.json["accessors"][is[item.key()].get<std::size_t>()];
      const Json& other = expected.json["accessors"][item.value().get<std::size_t>()];
      for (const char* key : {"componentType", "count", "type"}) CHECK(one[key] == other[key]);
      CHECK(one.value("normalized", false) == other.value("normalized", false));
    }
    CHECK(decoded(out->bytes.joined())->surfaces()[0].mesh.positions.size() == 8);
  }
}
