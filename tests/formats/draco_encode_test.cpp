// Draco on the way out: errors stay below what is stated, and what was there stays.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include <catch2/catch.hpp>
#include <unistd.h>

#include "core/shapes.h"
#include "proto/formats/bytes.h"
#include "proto/formats/draco_encoder.h"
#include "proto/formats/draco_header.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_mesh.h"
#include "tests/formats/draco_samples.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// A bent sheet of 21 × 21 vertices as a surface with results.
struct Sheet {
  Surface surface;
  std::vector<SurfaceResult> results;
};

Sheet make_sheet() {
  constexpr Index kSide = 21;
  Sheet out;
  out.surface.name = "mesh";
  VertexAttribute k1{"_CURVATURE_K1", 1, {}};
  VertexAttribute dir{"_CURVATURE_DIR1", 3, {}};
  VertexAttribute feature{"_FEATURE", 1, {}};
  for (Index i = 0; i < kSide * kSide; ++i) {
    const double x = 0.37 * (i % kSide);
    const Index row = i / kSide;
    const double y = 0.41 * row;
    out.surface.mesh.positions.emplace_back(x - 3.0, y + 100.0, std::sin(x) * std::cos(y));
    out.surface.normals.push_back(Vec3(std::cos(x), 0.3, 1.0).normalized());
    k1.values.push_back(static_cast<float>(std::sin(3.0 * x) - y));
    feature.values.push_back(i % 5 == 0 ? 1.0F : 0.0F);
    for (const double c : {std::sin(x), std::cos(x), 0.0}) {
      dir.values.push_back(static_cast<float>(c));
    }
    if (i % kSide + 1 == kSide || i / kSide + 1 == kSide) continue;
    out.surface.mesh.triangles.push_back({i, i + 1, i + kSide + 1});
    out.surface.mesh.triangles.push_back({i, i + kSide + 1, i + kSide});
  }
  out.results.push_back({false, {}, {}, {k1, dir, feature}});
  return out;
}

const DracoAttribute& named(const DracoMesh& mesh, std::string_view name) {
  for (const DracoAttribute& attribute : mesh.attributes()) {
    if (attribute.name == name) return attribute;
  }
  FAIL("no attribute " << name);
  return mesh.attributes().front();
}

double largest_error(const std::vector<double>& found, const std::vector<float>& expected) {
  REQUIRE(found.size() == expected.size());
  double out = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    out = std::max(out, std::abs(found[i] - static_cast<double>(expected[i])));
  }
  return out;
}

double largest_error(const std::vector<Vec3>& found, const std::vector<Vec3>& expected) {
  REQUIRE(found.size() == expected.size());
  double out = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    out =
        std::max(out, (found[i] - expected[i].cast<float>().cast<double>()).cwiseAbs().maxCoeff());
  }
  return out;
}

Encoded encoded(const Sheet& sheet, const DracoOptions& options) {
  auto out = write_fresh_draco(sheet.surface, sheet.results.front(), options);
  REQUIRE(out);
  return *out;
}

}  // namespace

TEST_CASE("a Draco mesh with several positions is written in whichever order, all of them kept") {
  const Sheet sheet = make_sheet();
  DracoSource source;
  source.triangles = sheet.surface.mesh.triangles;
  source.points = static_cast<Index>(sheet.surface.mesh.positions.size());
  for (int i = 0; i < 3; ++i)
    source.parts.push_back(position_part(sheet.surface.mesh.positions, {}));
  for (const DracoOrder order : {DracoOrder::kept, DracoOrder::free}) {
    const auto stream = encode_draco(source, 7, order);
    REQUIRE(stream);
    const auto mesh = DracoMesh::decode(stream->bytes);
    REQUIRE(mesh);
    CHECK(mesh->attributes().size() == 3);
    CHECK(mesh->triangles().size() == source.triangles.size());
  }
}

TEST_CASE("integers of a Draco file that lie 2^32 apart are kept") {
  DracoSampleOptions options;
  options.integers = true;
  const Bytes file = draco_cube(options);
  const auto document = decoded(file, Format::drc);
  std::vector<SurfaceResult> results(1);
  results[0].attributes.push_back({"_FEATURE", 1, std::vector<float>(8, 1.0F)});
  const auto before = DracoMesh::decode(file);
  REQUIRE(before);
  for (const bool keep_order : {true, false}) {
    Encoding encoding;
    encoding.draco.keep_order = keep_order;
    const auto out = document->write(results, Format::drc, encoding);
    REQUIRE(out);
    const auto after = DracoMesh::decode(out->bytes.joined());
    REQUIRE(after);
    auto expected = *before->values(before->attributes()[1]);
    auto found = *after->values(after->attributes()[1]);
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    CHECK(found == expected);
  }
}

TEST_CASE("Draco keeps order, and no value is off by more than is stated") {
  const Sheet sheet = make_sheet();
  const SurfaceResult& result = sheet.results.front();
  for (const int bits : {8, 14, 16, 24}) {
    DracoOptions options;
    options.position_bits = options.curvature_bits = bits;
    options.level = bits % 11;
    const Encoded out = encoded(sheet, options);
    const auto document = decoded(out.bytes.joined(), Format::drc);
    const Surface& surface = document->surfaces()[0];
    const SurfaceGrids grids =
        make_surface_grids(sheet.surface.mesh.positions, result.attributes, options);
    CHECK(surface.mesh.triangles == sheet.surface.mesh.triangles);
    const double off = largest_error(surface.mesh.positions, sheet.surface.mesh.positions);
    CHECK(off <= grids.position->error);
    CHECK(off > 0.0);
    const auto mesh = DracoMesh::decode(out.bytes.joined());
    REQUIRE(mesh);
    for (std::size_t i = 0; i < result.attributes.size(); ++i) {
      const VertexAttribute& attribute = result.attributes[i];
      const auto values = mesh->values(named(*mesh, attribute.name));
      REQUIRE(values);
      CHECK(largest_error(*values, attribute.values) <= grids.attributes[i]->error);
    }
    CHECK(grids.attributes[2]->error == 0.0);
  }
}

TEST_CASE("the stated error is half a step, and a step is the range over 2^bits - 1") {
  const std::vector<float> values = {-3.0F, 1.0F, 5.0F};
  const auto grid = make_grid(value_bounds(values, 1), 10);
  REQUIRE(grid);
  CHECK(grid->step() == Approx(8.0 / 1023));
  CHECK(grid->error == Approx(4.0 / 1023).epsilon(1e-3));
  CHECK(describe_grid("_X", grid) == "_X is off by at most 0.00391 (steps of 0.00782, 10 bits)");
  const auto note = encoded(make_sheet(), {}).notes;
  REQUIRE(note.size() == 1);
  CHECK(note[0].find("mesh as Draco: POSITION is off by at most 0.000") == 0);
  INFO(note[0]);
  CHECK(note[0].find("; _CURVATURE_K1 is off by at most 8.13e-05") != std::string::npos);
  CHECK(note[0].find("; _FEATURE is exact") != std::string::npos);
}

TEST_CASE("zero bits keep every float") {
  Sheet sheet = make_sheet();
  sheet.results[0].attributes[0].values[7] = 3e38F;
  sheet.results[0].attributes[0].values[8] = -3e38F;
  DracoOptions options;
  options.position_bits = options.normal_bits = options.curvature_bits = 0;
  const Encoded out = encoded(sheet, options);
  const auto document = decoded(out.bytes.joined(), Format::drc);
  const Surface& surface = document->surfaces()[0];
  CHECK(largest_error(surface.mesh.positions, sheet.surface.mesh.positions) == 0.0);
  CHECK(largest_error(surface.normals, sheet.surface.normals) < 1e-7);
  const auto mesh = DracoMesh::decode(out.bytes.joined());
  const auto values = mesh->values(named(*mesh, "_CURVATURE_K1"));
  CHECK(largest_error(*values, sheet.results[0].attributes[0].values) == 0.0);
  // No grid spans such a range: those values stay floats for any number of bits.
  const auto rounded = DracoMesh::decode(encoded(sheet, {}).bytes.joined());
  CHECK(largest_error(*rounded->values(named(*rounded, "_CURVATURE_K1")),
                      sheet.results[0].attributes[0].values) == 0.0);
}

TEST_CASE("a surface of one place, and normals of length zero, are stored") {
  Sheet sheet = make_sheet();
  sheet.results[0].attributes[0].values.assign(441, -2.5F);
  sheet.surface.normals[3] = Vec3::Zero();
  const auto mesh = DracoMesh::decode(encoded(sheet, {}).bytes.joined());
  REQUIRE(mesh);
  CHECK(largest_error(*mesh->values(named(*mesh, "_CURVATURE_K1")),
                      sheet.results[0].attributes[0].values) == 0.0);
  const auto normals = mesh->values(*mesh->find(DracoKind::normal));
  CHECK((*normals)[9] == 0.0);
  CHECK((*normals)[11] == 0.0);
}

TEST_CASE("where the order is free Draco is smaller and holds the same triangles") {
  const Sheet sheet = make_sheet();
  DracoOptions options;
  const Encoded kept = encoded(sheet, options);
  options.keep_order = false;
  const Encoded free = encoded(sheet, options);
  CHECK(free.bytes.size() < kept.bytes.size());
  CHECK(kept.bytes.joined()[8] == std::byte{0});
  CHECK(free.bytes.joined()[8] == std::byte{1});
  const auto corner_sum = [](const Bytes& bytes) {
    const auto document = decoded(bytes, Format::drc);
    const IndexedMesh& mesh = document->surfaces()[0].mesh;
    std::vector<double> areas;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 sum = mesh.positions[a] + mesh.positions[b] + mesh.positions[c];
      areas.push_back(sum.dot(Vec3(1.0, 17.0, 0.3)));
    }
    std::sort(areas.begin(), areas.end());
    return areas;
  };
  const auto before = corner_sum(kept.bytes.joined());
  const auto after = corner_sum(free.bytes.joined());
  REQUIRE(before.size() == after.size());
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(after[i] == Approx(before[i]));
}

TEST_CASE("a mesh that compresses to next to nothing can still be read back") {
  // All triangles the same: the faces take no bytes where they are compressed.
  Surface surface;
  surface.name = "mesh";
  surface.mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  surface.mesh.triangles.assign(200000, {0, 1, 2});
  const auto out = write_fresh_draco(surface, {}, {});
  REQUIRE(out);
  CHECK(check_draco_header(out->bytes.joined()));
  CHECK(decoded(out->bytes.joined(), Format::drc)->surfaces()[0].mesh.triangles.size() == 200000);
}

TEST_CASE("drc comes back as drc with everything that did not move") {
  const Bytes before = draco_cube({false, true, true, true});
  const auto document = decoded(before, Format::drc);
  CHECK(*document->encode(unmoved(*document), Format::drc) == before);
  auto results = shifted(*document, Vec3(5, 0, 0));
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  const auto out = document->encode(results, Format::drc);
  REQUIRE(out);
  const auto old = DracoMesh::decode(before);
  const auto mesh = DracoMesh::decode(*out);
  REQUIRE(mesh);
  REQUIRE(mesh->attributes().size() == 5);
  CHECK(mesh->triangles() == old->triangles());
  for (const DracoAttribute& was : old->attributes()) {
    const DracoAttribute* is = mesh->find_unique(was.unique_id);
    REQUIRE(is != nullptr);
    CHECK(is->kind == was.kind);
    CHECK(is->type == was.type);
    CHECK(is->normalized == was.normalized);
  }
  CHECK(*mesh->values(*mesh->find(DracoKind::color)) == *old->values(*old->find(DracoKind::color)));
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 found = decoded(*out, Format::drc)->surfaces()[0].mesh.positions[i];
    CHECK((found - results[0].positions[i]).norm() < 2e-4);
  }
}

TEST_CASE("drc to glb to drc keeps geometry and curvature") {
  const Sheet sheet = make_sheet();
  const Encoded first = encoded(sheet, {});
  const auto drc = decoded(first.bytes.joined(), Format::drc);
  const auto glb = drc->encode(unmoved(*drc), Format::glb);
  REQUIRE(glb);
  const auto scene = decoded(*glb);
  SampleGlb sample = parse_sample(*glb);
  const Json& attributes = sample.json["meshes"][0]["primitives"][0]["attributes"];
  auto results = unmoved(*scene);
  for (const VertexAttribute& was : sheet.results[0].attributes) {
    REQUIRE(attributes.contains(was.name));
    results[0].attributes.push_back(
        {was.name, was.components, floats_of(sample, attributes[was.name].get<std::size_t>())});
  }
  const auto second = convert(*scene, results, Format::glb, Format::drc);
  REQUIRE(second);
  const auto one = DracoMesh::decode(first.bytes.joined());
  const auto two = DracoMesh::decode(*second);
  REQUIRE(two);
  CHECK(two->triangles() == one->triangles());
  const auto again = decoded(*second, Format::drc);
  // The same grid a second time: nothing but the last bits of a float.
  CHECK(largest_error(again->surfaces()[0].mesh.positions, drc->surfaces()[0].mesh.positions) <
        2e-5);
  for (const VertexAttribute& was : results[0].attributes) {
    CHECK(largest_error(*two->values(named(*two, was.name)), was.values) < 1e-5);
  }
}

TEST_CASE("curvature of a drc is replaced, its own attributes are not") {
  const Sheet sheet = make_sheet();
  Sheet other = sheet;
  other.results[0].attributes.push_back({"_MINE", 2, std::vector<float>(2 * 441, 0.123456F)});
  const auto document = decoded(encoded(other, {}).bytes.joined(), Format::drc);
  auto results = unmoved(*document);
  results[0].attributes.push_back({"_CURVATURE_K1", 1, std::vector<float>(441, 7.0F)});
  const auto out = document->encode(results, Format::drc);
  REQUIRE(out);
  const auto mesh = DracoMesh::decode(*out);
  CHECK(mesh->attributes().size() == 6);
  CHECK(mesh->values(named(*mesh, "_CURVATURE_K1"))->at(5) == 7.0);
  CHECK(mesh->values(named(*mesh, "_MINE"))->at(5) == static_cast<double>(0.123456F));
}

TEST_CASE("every format becomes drc, but not a scene of several meshes") {
  const auto glb = decoded(cube_sample().glb());
  for (const Format came : {Format::ply, Format::obj, Format::stl, Format::drc, Format::gltf}) {
    const auto bytes = convert(*glb, unmoved(*glb), Format::glb, came);
    REQUIRE(bytes);
    const auto document = decoded(*bytes, came);
    const auto drc = convert(*document, unmoved(*document), came, Format::drc);
    REQUIRE(drc);
    CHECK(decoded(*drc, Format::drc)->surfaces()[0].mesh.triangles.size() == 12);
  }
  SampleGlb two = cube_sample();
  two.json["meshes"].push_back(two.json["meshes"][0]);
  const auto scene = decoded(two.glb());
  const auto refused = convert(*scene, unmoved(*scene), Format::glb, Format::drc);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::unsupported_feature);
}

TEST_CASE("draco_decoder reads what is written") {
  if (std::system("command -v draco_decoder >/dev/null 2>&1") != 0) {  // NOLINT: tests only
    std::cout << "SKIPPED: draco_decoder is not installed (Debian package draco)\n";
    return;
  }
  const Sheet sheet = make_sheet();
  for (const bool keep_order : {true, false}) {
    DracoOptions options;
    options.keep_order = keep_order;
    const Encoded out = encoded(sheet, options);
    const auto folder =
        std::filesystem::temp_directory_path() / ("fairway_draco_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const auto drc = (folder / "sheet.drc").string();
    const auto ply = (folder / "sheet.ply").string();
    std::ofstream(drc, std::ios::binary)
        .write(reinterpret_cast<const char*>(out.bytes.joined().data()),
               static_cast<std::streamsize>(out.bytes.size()));
    const std::string command = "draco_decoder -i " + drc + " -o " + ply + " >/dev/null";
    REQUIRE(std::system(command.c_str()) == 0);  // NOLINT: tests only
    std::ifstream file(ply, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    std::filesystem::remove_all(folder);
    const auto other = decoded(text_bytes(text), Format::ply);
    const auto own = decoded(out.bytes.joined(), Format::drc);
    CHECK(other->surfaces()[0].mesh.positions == own->surfaces()[0].mesh.positions);
    CHECK(other->surfaces()[0].mesh.triangles == own->surfaces()[0].mesh.triangles);
    CHECK(own->surfaces()[0].mesh.triangles.size() == sheet.surface.mesh.triangles.size());
  }
}
