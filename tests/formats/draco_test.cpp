#include <catch2/catch.hpp>

#include "proto/formats/document.h"
#include "proto/formats/draco_header.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/tinygltf_reader.h"

using namespace fairway;
using namespace fairway::test;

namespace {

constexpr DracoSampleOptions kEverything = {true, true, true, true};

ErrorCode refusal(const Bytes& bytes, Format format = Format::drc) {
  const auto document = decode(bytes, format);
  REQUIRE_FALSE(document);
  return document.error().code;
}

/// "DRACO" 2.2, triangular mesh, sequential, no flags, then `rest`.
Bytes sequential_header(const std::vector<std::uint8_t>& rest) {
  Bytes out = text_bytes(std::string("DRACO\x02\x02\x01\x00\x00\x00", 11));
  for (const auto b : rest) out.push_back(std::byte(b));
  return out;
}

Json& primitive_of(SampleGlb& sample) {
  return sample.json["meshes"][0]["primitives"][0];
}

Vec3 corner(std::size_t i) {
  const auto c = cube_corners()[i];
  return {c[0], c[1], c[2]};
}

}  // namespace

TEST_CASE("a Draco mesh becomes a surface over its points") {
  for (const bool edgebreaker : {false, true}) {
    const auto document = decoded(draco_cube({edgebreaker, true, false, false}), Format::drc);
    const Surface& surface = document->surfaces().at(0);
    REQUIRE(surface.mesh.positions.size() == 8);
    CHECK(surface.normals.size() == 8);
    CHECK(surface.mesh.triangles.size() == 12);
    for (const Vec3& p : surface.mesh.positions) CHECK(p.cwiseAbs().isApproxToConstant(1.0, 1e-3));
  }
  const auto sequential = decoded(draco_cube(), Format::drc);
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK((sequential->surfaces()[0].mesh.positions[i] - corner(i)).norm() < 1e-3);
  }
}

TEST_CASE("a Draco mesh comes back as a new glTF that tinygltf reads") {
  const auto document = decoded(draco_cube(kEverything), Format::drc);
  auto results = shifted(*document, Vec3(1, 0, 0));
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  for (const Format format : {Format::glb, Format::gltf}) {
    const auto out = document->encode(results, format);
    REQUIRE(out);
    const OtherReading reading = read_with_tinygltf(*out, format);
    INFO(reading.problem);
    REQUIRE(reading.loaded);
    CHECK(reading.generator == "fairway");
    CHECK(reading.nodes == 1);
    CHECK(reading.indices.size() == 36);
    for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0", "_CURVATURE_MEAN"}) {
      CHECK(reading.attributes.count(name) == 1);
    }
    CHECK(reading.attributes.at("_CURVATURE_MEAN") == results[0].attributes[0].values);
    const auto again = decoded(*out, format);
    for (std::size_t i = 0; i < 8; ++i) {
      CHECK(again->surfaces()[0].mesh.positions[i] ==
            results[0].positions[i].cast<float>().cast<double>());
    }
  }
}

TEST_CASE("every truncation of a Draco mesh is refused as malformed") {
  const Bytes whole = draco_cube({true, true, false, false});
  REQUIRE(decode(whole, Format::drc));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(refusal(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))) ==
          ErrorCode::malformed_input);
  }
}

TEST_CASE("Draco headers are checked before the library believes them") {
  Bytes newer = draco_cube();
  newer[6] = std::byte{3};
  CHECK(refusal(newer) == ErrorCode::unsupported_format);
  Bytes geometry = draco_cube();
  geometry[7] = std::byte{2};
  CHECK(refusal(geometry) == ErrorCode::invalid_mesh);
  CHECK(refusal(draco_point_cloud()) == ErrorCode::no_triangles);
  CHECK(refusal(text_bytes("{\"asset\":{}}")) == ErrorCode::unsupported_format);
  // 2^32 - 1 faces, a million faces, 2^32 - 1 points.
  CHECK(refusal(sequential_header({0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 3, 1})) ==
        ErrorCode::invalid_mesh);
  CHECK(refusal(sequential_header({0xC0, 0x84, 0x3D, 3, 0})) == ErrorCode::invalid_mesh);
  CHECK(refusal(sequential_header({1, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 1})) ==
        ErrorCode::invalid_mesh);
}

TEST_CASE("Draco answers that are broken are refused after decoding") {
  // Sequential encoding stores the indices of a small mesh as bytes behind header and counts.
  Bytes beyond = draco_cube();
  REQUIRE(beyond[14] == std::byte{0});
  REQUIRE(beyond[15] == std::byte{2});
  beyond[15] = std::byte{8};
  CHECK(refusal(beyond) == ErrorCode::invalid_mesh);
  // One face (0, 1, 200) of three points; one face (0, 1, 2) without any attribute; no face.
  CHECK(refusal(sequential_header({1, 3, 1, 0, 1, 200, 0})) == ErrorCode::invalid_mesh);
  CHECK(refusal(sequential_header({1, 3, 1, 0, 1, 2, 0})) == ErrorCode::invalid_mesh);
  CHECK(refusal(sequential_header({0, 0, 1, 0, 0, 0, 0})) == ErrorCode::no_triangles);
}

TEST_CASE("metadata in front of a Draco mesh is skipped within its bytes") {
  // Flag 0x8000, no attribute metadata, one entry "a" = 2 bytes, no children; then one face.
  Bytes bytes = sequential_header({0, 1, 1, 'a', 2, 9, 9, 0, 1, 3, 1, 0, 1, 2, 0});
  bytes[10] = std::byte{0x80};
  CHECK(check_draco_header(bytes));
  bytes[15] = std::byte{100};
  CHECK_FALSE(check_draco_header(bytes));
}

TEST_CASE("compressed primitives come back plain") {
  for (const bool moved : {false, true}) {
    const SampleGlb before = draco_glb(kEverything);
    const auto document = decoded(before.glb());
    REQUIRE(document->surfaces()[0].mesh.positions.size() == 8);
    CHECK(document->surfaces()[0].normals.size() == 8);
    auto results = moved ? shifted(*document, Vec3(1, 0, 0)) : unmoved(*document);
    add_ramp(*document, "_CURVATURE_MEAN", 1, results);
    const auto out = document->encode(results, Format::glb);
    REQUIRE(out);
    SampleGlb after = parse_sample(*out);
    CHECK_FALSE(after.json.contains("extensionsUsed"));
    CHECK_FALSE(after.json.contains("extensionsRequired"));
    CHECK_FALSE(primitive_of(after).contains("extensions"));
    // The labels are filled: no accessor is left over.
    CHECK(after.json["accessors"].size() == before.json["accessors"].size() + 1);
    for (const Json& accessor : after.json["accessors"]) CHECK(accessor.contains("bufferView"));
    CHECK(after.json["accessors"][0]["max"][0].get<double>() == Approx(moved ? 2.0 : 1.0));
    const OtherReading reading = read_with_tinygltf(*out, Format::glb);
    INFO(reading.problem);
    REQUIRE(reading.loaded);
    CHECK(reading.indices.size() == 36);
    CHECK(reading.attributes.at("TEXCOORD_0").size() == 16);
    const auto again = decoded(*out);
    const Vec3 by = moved ? Vec3(1, 0, 0) : Vec3(0, 0, 0);
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3 expected = document->surfaces()[0].mesh.positions[i] + by;
      CHECK(again->surfaces()[0].mesh.positions[i] == expected.cast<float>().cast<double>());
    }
    CHECK(again->surfaces()[0].mesh.triangles == document->surfaces()[0].mesh.triangles);
  }
}

TEST_CASE("three-byte colours of a compressed primitive are padded to four") {
  const auto document = decoded(draco_glb(kEverything).glb());
  SampleGlb after = parse_sample(*document->encode(unmoved(*document), Format::glb));
  const Json& color =
      after.json["accessors"][primitive_of(after)["attributes"]["COLOR_0"].get<std::size_t>()];
  CHECK(color["normalized"] == true);
  const Json& view = after.json["bufferViews"][color["bufferView"].get<std::size_t>()];
  CHECK(view["byteStride"] == 4);
  const std::size_t at = view["byteOffset"].get<std::size_t>();
  CHECK(after.bin[at + 1] == std::byte{100});
  CHECK(after.bin[at + 6] == std::byte{200});
}

TEST_CASE("primitives that share compressed data each come back plain") {
  SampleGlb sample = draco_glb();
  sample.json["meshes"].push_back(sample.json["meshes"][0]);
  const auto document = decoded(sample.glb());
  REQUIRE(document->surfaces().size() == 2);
  SampleGlb after = parse_sample(*document->encode(unmoved(*document), Format::glb));
  CHECK_FALSE(after.json.contains("extensionsUsed"));
  // Two primitives name the labels, so they are kept as they were and each mesh has its own.
  CHECK_FALSE(after.json["accessors"][0].contains("bufferView"));
  CHECK(decoded(after.glb())->surfaces()[1].mesh.triangles.size() == 12);
}

TEST_CASE("a compressed attribute that its accessor cannot hold is refused when the file is read") {
  for (const char* type : {"SCALAR", "VEC3", "MAT2"}) {
    SampleGlb sample = draco_glb(kEverything);
    const auto accessor = primitive_of(sample)["attributes"]["TEXCOORD_0"].get<std::size_t>();
    sample.json["accessors"][accessor]["type"] = type;
    const Bytes glb = sample.glb();
    const auto document = decode(glb, Format::glb);
    REQUIRE_FALSE(document);
    CHECK(document.error().code == ErrorCode::invalid_mesh);
    CHECK(document.error().pointer == "/meshes/0/primitives/0");
  }
}

TEST_CASE("compressed primitives whose labels disagree with the data are refused") {
  for (const std::size_t accessor : {0U, 1U}) {
    for (const int count : {3, 100000}) {
      SampleGlb sample = draco_glb();
      sample.json["accessors"][accessor]["count"] = count;
      CHECK(refusal(sample.glb(), Format::glb) == ErrorCode::invalid_mesh);
    }
  }
  const auto broken = [](const char* key, const Json& value) {
    SampleGlb sample = draco_glb();
    primitive_of(sample)["extensions"]["KHR_draco_mesh_compression"][key] = value;
    return refusal(sample.glb(), Format::glb);
  };
  CHECK(broken("attributes", Json::object()) == ErrorCode::invalid_mesh);
  CHECK(broken("attributes", {{"POSITION", 99}}) == ErrorCode::invalid_mesh);
  CHECK(broken("bufferView", 7) == ErrorCode::invalid_mesh);
  SampleGlb cut = draco_glb();
  cut.json["bufferViews"][0]["byteLength"] = 30;
  const auto document = decode(cut.glb(), Format::glb);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::invalid_mesh);
  CHECK(document.error().pointer == "/meshes/0/primitives/0");
}
