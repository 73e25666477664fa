// From format to format by the tool: what is geometry stays.

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "core/triangle_mesh.h"
#include "proto/formats/draco_decoder.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

/// Writes `from` as `to`, nothing moved.
void convert_file(const std::string& from, const std::string& to,
                  const std::string& parameters = R"({"steps":0,"curvature":[]})") {
  const ToolRun run = run_tool({"denoise", from, to, "--params", parameters});
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
}

/// The corners of every triangle, in their order: STL numbers vertices anew.
std::vector<Vec3> corners_of(const IndexedMesh& mesh) {
  std::vector<Vec3> out;
  for (const Triangle& triangle : mesh.triangles) {
    for (const Index vertex : triangle) out.push_back(mesh.positions[vertex]);
  }
  return out;
}

struct NamedValues {
  std::vector<double> positions, k1;
};

NamedValues read_draco(const std::string& path) {
  const Bytes bytes = read_bytes(path);
  const auto mesh = DracoMesh::decode(bytes);
  REQUIRE(mesh);
  NamedValues out;
  for (const DracoAttribute& attribute : mesh->attributes()) {
    const auto values = mesh->values(attribute);
    REQUIRE(values);
    if (attribute.kind == DracoKind::position) out.positions = *values;
    if (attribute.name == "_CURVATURE_K1") out.k1 = *values;
  }
  return out;
}

}  // namespace

TEST_CASE("PLY to OBJ to STL to PLY keeps every corner of every triangle bit for bit") {
  const TemporaryDirectory directory;
  const std::string base = directory.path() / "mesh";
  write_bytes(base + ".glb", glb_of(with_normal_noise(sphere(3, 1.7), 0.2, 1)));
  convert_file(base + ".glb", base + ".ply");
  convert_file(base + ".ply", base + ".obj");
  convert_file(base + ".obj", base + ".stl");
  convert_file(base + ".stl", base + "-again.ply");
  const IndexedMesh first = mesh_of(base + ".ply", Format::ply);
  const IndexedMesh last = mesh_of(base + "-again.ply", Format::ply);
  CHECK(last.positions.size() == first.positions.size());
  CHECK(corners_of(last) == corners_of(first));
  CHECK(corners_of(mesh_of(base + ".glb")) == corners_of(first));
}

TEST_CASE("Draco to GLB to Draco keeps triangles, and values as near as the bits say") {
  const TemporaryDirectory directory;
  const std::string base = directory.path() / "mesh";
  write_bytes(base + ".glb", glb_of(with_normal_noise(sphere(3, 1.7), 0.2, 1)));
  convert_file(base + ".glb", base + ".drc", R"({"steps":0})");
  const auto* compression = GENERATE("none", "draco", "meshopt", "keep");
  CAPTURE(compression);
  convert_file(base + ".drc", base + "-fresh.glb",
               std::string(R"({"steps":0,"curvature":[],"compression":")") + compression + "\"}");
  convert_file(base + "-fresh.glb", base + "-again.drc",
               R"({"steps":0,"draco":{"position_bits":20}})");
  const IndexedMesh first = mesh_of(base + ".drc", Format::drc);
  const IndexedMesh last = mesh_of(base + "-again.drc", Format::drc);
  CHECK(last.triangles == first.triangles);
  const NamedValues was = read_draco(base + ".drc");
  const NamedValues is = read_draco(base + "-again.drc");
  REQUIRE(is.positions.size() == was.positions.size());
  REQUIRE(is.k1.size() == was.positions.size() / 3);
  REQUIRE(was.k1.size() == is.k1.size());
  // Extent 3.6: half a step of 14 bits, and nearly nothing of 20.
  for (std::size_t i = 0; i < is.positions.size(); ++i) {
    CHECK(std::abs(is.positions[i] - was.positions[i]) < 1.2e-4);
  }
}

}  // namespace fairway::test
