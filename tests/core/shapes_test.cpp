// The generated shapes are what they say.

#include "core/shapes.h"

#include <Eigen/Geometry>
#include <numbers>

#include <catch2/catch.hpp>

#include "core/surface_geometry.h"

namespace fairway::test {

TEST_CASE("closed shapes enclose their volume with outward normals") {
  const auto volume = [](const IndexedMesh& source) {
    const TriangleMesh mesh = *TriangleMesh::build(source);
    CHECK(mesh.counts().boundary_edges == 0);
    CHECK(mesh.vertex_count() == source.positions.size());
    return enclosed_volume(mesh, mesh.positions());
  };
  const double pi = std::numbers::pi;
  CHECK(volume(sphere(5, 2.0)) == Approx(4.0 / 3.0 * pi * 8.0).epsilon(2e-3));
  CHECK(volume(octahedron(7)) == Approx(4.0 / 3.0).epsilon(1e-12));
  CHECK(volume(ring(300, 4)) == Approx(2.0 * pi * 0.44 * 0.44).epsilon(1e-3));
  CHECK(volume(torus(200, 100, 1.0, 0.4)) == Approx(2.0 * pi * pi * 0.16).epsilon(2e-3));
}

TEST_CASE("noise has the strength asked for and repeats for its seed") {
  const IndexedMesh clean = sphere(4, 1.0);
  const TriangleMesh mesh = *TriangleMesh::build(clean);
  const double mean_edge = mean_edge_length(mesh, mesh.positions());
  const IndexedMesh noisy = with_normal_noise(clean, 0.3, 9);
  double sum = 0.0;
  for (std::size_t v = 0; v < clean.positions.size(); ++v) {
    sum += (noisy.positions[v] - clean.positions[v]).squaredNorm();
  }
  const double deviation = std::sqrt(sum / static_cast<double>(clean.positions.size()));
  CHECK(deviation == Approx(0.3 * mean_edge).epsilon(0.05));
  CHECK(with_normal_noise(clean, 0.3, 9).positions == noisy.positions);
  CHECK(with_normal_noise(clean, 0.3, 10).positions != noisy.positions);
}

TEST_CASE("a mesh has no normal error against itself and 180 degrees turned inside out") {
  const IndexedMesh mesh = octahedron(4);
  CHECK(mean_normal_error(mesh, mesh) == Approx(0.0).margin(1e-6));
  IndexedMesh flat = sheet(2);
  IndexedMesh over = flat;
  for (Vec3& p : over.positions) p.x() = -p.x();
  CHECK(mean_normal_error(flat, over) == Approx(180.0));
}

}  // namespace fairway::test
