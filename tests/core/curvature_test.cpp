// Curvature of surfaces whose curvature is known.

#include "core/curvature.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "core/shapes.h"

namespace fairway::test {
namespace {

CurvatureFields of(const IndexedMesh& source) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  return scatter(*mesh, curvature(*mesh, mesh->positions()));
}

/// Root mean square error of the larger principal curvature on a torus, relative to its range.
double torus_error(Index n) {
  constexpr double kMajor = 1.0;
  constexpr double kMinor = 0.4;
  const IndexedMesh mesh = torus(2 * n, n, kMajor, kMinor);
  const CurvatureFields k = of(mesh);
  double sum = 0.0;
  for (std::size_t v = 0; v < k.k1.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    const double ring_radius = std::hypot(p.x(), p.y());
    const double along = (ring_radius - kMajor) / (kMinor * ring_radius);
    sum += std::pow(k.k1[v] - 1.0 / kMinor, 2) + std::pow(k.k2[v] - along, 2);
  }
  return std::sqrt(sum / static_cast<double>(2 * k.k1.size())) * kMinor;
}

}  // namespace

TEST_CASE("a sphere of radius 2 has k1 = k2 = 0.5 within 1 %") {
  const CurvatureFields k = of(sphere(4, 2.0));
  for (std::size_t v = 0; v < k.k1.size(); ++v) {
    CHECK(k.k1[v] == Approx(0.5).epsilon(0.01));
    CHECK(k.k2[v] == Approx(0.5).epsilon(0.01));
    CHECK(k.mean[v] == Approx(0.5).epsilon(0.01));
    CHECK(k.predominant[v] == Approx(0.5).epsilon(0.01));
    CHECK(k.gaussian[v] == Approx(0.25).epsilon(0.02));
  }
}

TEST_CASE("an inside-out sphere is concave") {
  IndexedMesh mesh = sphere(2, 1.0);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  for (const double k : of(mesh).k1) CHECK(k < -0.9);
}

TEST_CASE("curvature of a torus converges with second order") {
  const double coarse = torus_error(16);
  const double middle = torus_error(32);
  const double fine = torus_error(64);
  CHECK(coarse < 0.05);
  CHECK(coarse / middle > 3.0);
  CHECK(middle / fine > 3.0);
}

TEST_CASE("the direction of the larger curvature of a torus runs around its tube") {
  const IndexedMesh mesh = torus(64, 32, 1.0, 0.4);
  const CurvatureFields k = of(mesh);
  for (std::size_t v = 0; v < k.dir1.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    const Vec3 along = Vec3(-p.y(), p.x(), 0.0).normalized();
    CHECK(std::abs(k.dir2[v].dot(along)) > 0.999);
    CHECK(std::abs(k.dir1[v].dot(along)) < 0.05);
  }
}

TEST_CASE("a plane is flat, its boundary has no Gaussian curvature") {
  const CurvatureFields k = of(sheet(6));
  for (std::size_t v = 0; v < k.k1.size(); ++v) {
    CHECK(std::abs(k.k1[v]) < 1e-12);
    CHECK(std::abs(k.k2[v]) < 1e-12);
    CHECK(std::abs(k.gaussian[v]) < 1e-9);
  }
}

TEST_CASE("curvature scales with one over length") {
  IndexedMesh mesh = with_normal_noise(sphere(2, 1.0), 0.1, 5);
  const CurvatureFields one = of(mesh);
  for (Vec3& p : mesh.positions) p *= 1024.0;
  const CurvatureFields large = of(mesh);
  for (std::size_t v = 0; v < one.k1.size(); ++v) {
    CHECK(large.k1[v] * 1024.0 == Approx(one.k1[v]).margin(1e-9));
    CHECK(large.gaussian[v] * 1024.0 * 1024.0 == Approx(one.gaussian[v]).margin(1e-9));
  }
}

TEST_CASE("isolated vertices get zeros, welded copies equal values") {
  IndexedMesh mesh = sphere(1, 1.0);
  mesh.positions.push_back(mesh.positions[0]);
  mesh.positions.emplace_back(9.0, 9.0, 9.0);
  for (std::size_t i = 0; i < 3; ++i) {
    for (Index& v : mesh.triangles[i]) {
      if (v == 0) v = static_cast<Index>(mesh.positions.size()) - 2;
    }
  }
  const CurvatureFields k = of(mesh);
  CHECK(k.k1[mesh.positions.size() - 2] == k.k1[0]);
  CHECK(k.k1.back() == 0.0);
  CHECK(k.dir1.back().isZero());
}

TEST_CASE("curvature as floats is the curvature, rounded, on every instruction set") {
  const IndexedMesh source = with_normal_noise(torus(24, 11, 1.0, 0.4), 0.2, 7);
  const auto mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  for (const Isa isa : {Isa::portable, Isa::avx2, Isa::avx512}) {
    if (isa > best_isa()) continue;
    Execution execution;
    execution.isa = isa;
    const CurvatureFields k = curvature(*mesh, mesh->positions(), execution);
    const CurvatureFloats f = curvature_floats(*mesh, mesh->positions(), execution);
    for (std::size_t v = 0; v < mesh->vertex_count(); ++v) {
      CHECK(f.k1[v] == static_cast<float>(k.k1[v]));
      CHECK(f.k2[v] == static_cast<float>(k.k2[v]));
      CHECK(f.mean[v] == static_cast<float>(k.mean[v]));
      CHECK(f.gaussian[v] == static_cast<float>(k.gaussian[v]));
      CHECK(f.predominant[v] == static_cast<float>(k.predominant[v]));
      for (int c = 0; c < 3; ++c) {
        const std::size_t i = 3 * v + static_cast<std::size_t>(c);
        CHECK(f.dir1[i] == static_cast<float>(k.dir1[v][c]));
        CHECK(f.dir2[i] == static_cast<float>(k.dir2[v][c]));
      }
    }
  }
}

TEST_CASE("curvature beyond single precision becomes its largest number") {
  const auto mesh = TriangleMesh::build(sphere(1, 1e-30));
  REQUIRE(mesh);
  const CurvatureFloats k = curvature_floats(*mesh, mesh->positions());
  CHECK(k.mean[0] == Approx(1e30).epsilon(0.2));
  for (const float gaussian : k.gaussian) CHECK(gaussian == std::numeric_limits<float>::max());
}

}  // namespace fairway::test
