// What mending folded faces promises.

#include "core/fold_guard.h"

#include <Eigen/Geometry>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "core/surface_geometry.h"

namespace fairway::test {
namespace {

constexpr Index kCells = 10;
constexpr Index kMiddle = 60;  // the vertex in the middle of the sheet

struct Sheet {
  TriangleMesh mesh = *TriangleMesh::build(sheet(kCells));
  std::vector<Vec3> positions = mesh.positions();
  std::vector<unsigned char> held = std::vector<unsigned char>(mesh.vertex_count());
  Index middle = mesh.vertex_of_source()[kMiddle];

  std::size_t folded() const {
    const FaceGeometry faces = face_geometry(mesh, positions, 0.0);
    std::size_t count = 0;
    for (const Vec3& normal : faces.normals) count += normal.z() < 0.0 ? 1 : 0;
    return count;
  }
};

}  // namespace

TEST_CASE("a vertex that went over the far side of its faces comes back, and it alone moves") {
  Sheet s;
  s.positions[s.middle] += Vec3(0.25, 0.05, 0.0);
  REQUIRE(s.folded() > 0);
  const std::vector<Vec3> before = s.positions;
  CHECK(mend_folds(s.mesh, s.held, s.positions) > 0);
  CHECK(s.folded() == 0);
  for (std::size_t v = 0; v < before.size(); ++v) {
    CHECK(s.positions[v].z() == 0.0);
    if ((before[v] - before[s.middle]).norm() > 0.7) CHECK(s.positions[v] == before[v]);
  }
}

TEST_CASE("what is not folded stays bit for bit, thin triangles that were thin too") {
  IndexedMesh thin = sheet(kCells);
  for (Vec3& p : thin.positions) p.x() *= 1e-3;
  for (const IndexedMesh& source : {sheet(kCells), thin, octahedron(8)}) {
    const TriangleMesh mesh = *TriangleMesh::build(source);
    std::vector<Vec3> positions = mesh.positions();
    CHECK(mend_folds(mesh, std::vector<unsigned char>(positions.size()), positions) == 0);
    CHECK(positions == mesh.positions());
  }
}

TEST_CASE("held vertices stay where they are, folded or not") {
  Sheet s;
  s.positions[s.middle] += Vec3(0.25, 0.05, 0.0);
  s.held.assign(s.held.size(), 1);
  const std::vector<Vec3> before = s.positions;
  CHECK(mend_folds(s.mesh, s.held, s.positions) == 0);
  CHECK(s.positions == before);
}

}  // namespace fairway::test
