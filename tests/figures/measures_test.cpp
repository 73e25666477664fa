// What the figures measure, where the answer is known.

#include "tests/figures/measures.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "tests/figures/models.h"

using namespace fairway;

TEST_CASE("volume and area of an octahedron are those of the solid") {
  CHECK(volume_of(octahedron(5)) == Approx(4.0 / 3.0));
  CHECK(area_of(octahedron(5)) == Approx(4.0 * std::sqrt(3.0)));
}

TEST_CASE("distances are to faces, edges and corners of the original") {
  const IndexedMesh points = {{Vec3(1, 1, 1), Vec3(0, 0, 2), Vec3(0.5, 0.5, 0), Vec3(0, 0, 0)}, {}};
  const std::vector<double> d = distances(points, octahedron(1));
  CHECK(d[0] == Approx(2.0 / std::sqrt(3.0)));
  CHECK(d[1] == Approx(1.0));
  CHECK(d[2] == Approx(0.0).margin(1e-12));
  CHECK(d[3] == Approx(1.0 / std::sqrt(3.0)));
}

TEST_CASE("relative curvature is high on edges, zero on faces and does not know the unit") {
  IndexedMesh mesh = octahedron(6);
  const Result<std::vector<double>> values = relative_curvature(mesh);
  REQUIRE(values);
  for (Vec3& p : mesh.positions) p *= 1000.0;
  const Result<std::vector<double>> scaled = relative_curvature(mesh);
  REQUIRE(scaled);
  int flat = 0;
  for (std::size_t v = 0; v < values->size(); ++v) {
    const Vec3 p = mesh.positions[v].cwiseAbs();
    const bool inside_a_face = p.minCoeff() > 1e-9;
    CHECK((*scaled)[v] == Approx((*values)[v]).margin(1e-9));
    if (inside_a_face) CHECK((*values)[v] == Approx(0.0).margin(1e-9));
    if (!inside_a_face) CHECK((*values)[v] > 0.5);
    flat += inside_a_face ? 1 : 0;
  }
  CHECK(flat == 80);
}

TEST_CASE("the cotangent flow shrinks a flat sheet's boundary, which core's flow leaves alone") {
  const IndexedMesh flat = sheet(12);
  FlowOptions options;
  options.method = Method::mean_curvature;
  options.steps = 10;
  const Result<IndexedMesh> ours = after_flow(flat, options);
  REQUIRE(ours);
  CHECK(area_of(*ours) == Approx(4.0));
  CHECK(area_of(cotangent_flow(flat, 0.1, 10)) < 3.6);
}

TEST_CASE("away from boundaries the cotangent flow is core's mean curvature flow") {
  const IndexedMesh noisy = with_normal_noise(sphere(3, 1.0), 0.1, 1);
  FlowOptions options;
  options.method = Method::mean_curvature;
  options.steps = 5;
  options.step_size = 0.1;
  const Result<IndexedMesh> ours = after_flow(noisy, options);
  REQUIRE(ours);
  const IndexedMesh plain = cotangent_flow(noisy, 0.1, 5);
  double worst = 0.0;
  for (std::size_t v = 0; v < plain.positions.size(); ++v) {
    worst = std::max(worst, (plain.positions[v] - ours->positions[v]).norm());
  }
  CHECK(worst < 1e-3 * mean_edge_of(noisy));
}
