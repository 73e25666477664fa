// Curvature against analytic surfaces and topology: orders of convergence, and the sizes of the
// errors that the resolved formulas §2 give for regular and irregular sampling.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <catch2/catch.hpp>

#include "core/curvature.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "tests/core/generated_meshes.h"

namespace fairway::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// What a smooth surface has at a point on it; `across` is the direction of k1, zero where every
/// direction is.
struct Exact {
  double k1, k2;
  Vec3 across;
};
using Surface = std::function<Exact(const Vec3&)>;

struct Errors {
  double curvature;  ///< rms over k1 and k2, relative to the rms of the larger exact one
  double mean;       ///< rms of (k1 + k2)/2, relative to the same
  double direction;  ///< rms, degrees
};

Errors errors(const IndexedMesh& source, const Surface& exact) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  const CurvatureFields k = scatter(*mesh, curvature(*mesh, mesh->positions()));
  double wrong = 0.0;
  double mean = 0.0;
  double size = 0.0;
  double turned = 0.0;
  double count = 0.0;
  for (std::size_t v = 0; v < source.positions.size(); ++v) {
    // At a boundary the ring is one-sided: half of the shape operator is missing by design.
    if (mesh->boundary_vertex()[mesh->vertex_of_source()[v]] != 0) continue;
    const Exact e = exact(source.positions[v]);
    wrong += std::pow(k.k1[v] - e.k1, 2) + std::pow(k.k2[v] - e.k2, 2);
    mean += std::pow(k.mean[v] - 0.5 * (e.k1 + e.k2), 2);
    size += std::max(e.k1 * e.k1, e.k2 * e.k2);
    turned += std::pow(std::asin(std::min(1.0, k.dir1[v].cross(e.across).norm())) / kDegree, 2);
    count += 1.0;
  }
  return {std::sqrt(0.5 * wrong / size), std::sqrt(mean / size), std::sqrt(turned / count)};
}

// Of an edge: how far inner vertices of irregular samplings lie from the regular ones.
constexpr double kJitter = 0.2;
constexpr double kMajor = 1.0;
constexpr double kMinor = 0.4;

Exact on_torus(const Vec3& p) {
  const double distance = std::hypot(p.x(), p.y());
  const Vec3 outward = Vec3(p.x(), p.y(), 0.0) / distance;
  const Vec3 normal = (p - kMajor * outward) / kMinor;
  return {1.0 / kMinor, (distance - kMajor) / (kMinor * distance),
          normal.cross(Vec3(-outward.y(), outward.x(), 0.0))};
}

Exact on_sphere(const Vec3& p) {
  return {1.0 / p.norm(), 1.0 / p.norm(), Vec3::Zero()};
}

Exact on_cylinder(const Vec3& p) {
  const double radius = std::hypot(p.x(), p.y());
  return {1.0 / radius, 0.0, Vec3(-p.y(), p.x(), 0.0) / radius};
}

/// z = (x² − y²)/2 with upward normal (−x, y, 1)/W: convex positive, so the shape operator is
/// −(second fundamental form); its eigenvalues from mean and Gaussian curvature of the graph.
Exact on_saddle(const Vec3& p) {
  const double x = p.x();
  const double y = p.y();
  const double w = std::sqrt(1.0 + x * x + y * y);
  Eigen::Matrix2d first;
  first << 1.0 + x * x, -x * y, -x * y, 1.0 + y * y;
  Eigen::Matrix2d second;
  second << -1.0 / w, 0.0, 0.0, 1.0 / w;
  const Eigen::Matrix2d weingarten = first.inverse() * second;
  const double mean = 0.5 * weingarten.trace();
  const double root = std::sqrt(mean * mean - weingarten.determinant());
  const Eigen::Matrix2d shifted = weingarten - (mean - root) * Eigen::Matrix2d::Identity();
  // Columns of S − k2 lie along the eigenvector of k1.
  const Eigen::Vector2d u = shifted.col(shifted.col(0).norm() > shifted.col(1).norm() ? 0 : 1);
  return {mean + root, mean - root, Vec3(u.x(), u.y(), x * u.x() - y * u.y()).normalized()};
}

double euler_characteristic(const IndexedMesh& source) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  const double smallest = smallest_area(mean_edge_length(*mesh, mesh->positions()));
  const FaceGeometry faces = face_geometry(*mesh, mesh->positions(), smallest);
  double sum = 0.0;
  for (const double d : angle_defect(*mesh, mesh->positions(), faces)) sum += d;
  return sum / (2.0 * std::numbers::pi);
}

}  // namespace

TEST_CASE("curvature of a torus converges with second order, from 512 to 32768 vertices") {
  Errors before{};
  for (const auto& [n, bound] :
       {std::pair{16U, 1.6e-2}, {32U, 4e-3}, {64U, 1e-3}, {128U, 2.5e-4}}) {
    const Errors now = errors(torus(2 * n, n, kMajor, kMinor), on_torus);
    INFO(n << ": " << now.curvature << " rms, " << now.direction << " degrees");
    CHECK(now.curvature < bound);
    if (n > 16U) {
      CHECK(before.curvature / now.curvature > 3.9);
      CHECK(before.direction / now.direction > 3.9);
    }
    before = now;
  }
  CHECK(before.direction < 0.01);
}

TEST_CASE("curvature of a sphere: 1 % where regular; where not, 8 %, the mean 1.5 %") {
  for (const Index levels : {3U, 4U, 5U}) {
    CHECK(errors(sphere(levels, 2.0), on_sphere).curvature < 1e-2);
    const Errors irregular = errors(irregular_sphere(levels, 2.0, kJitter, levels), on_sphere);
    CHECK(irregular.curvature < 8e-2);
    CHECK(irregular.mean < 1.5e-2);
  }
}

TEST_CASE("curvature of an open cylinder and a saddle: 1 % where regular, 8 % where not") {
  for (const Index n : {32U, 64U, 128U}) {
    const Errors tube = errors(cylinder(n, n / 2, 0.5, 0.0, 1), on_cylinder);
    CHECK(tube.curvature < 1e-2);
    CHECK(tube.direction < 0.01);
    const Errors pass = errors(saddle(n, 0.0, 1), on_saddle);
    CHECK(pass.curvature < 1e-2);
    CHECK(pass.direction < 0.01);
    const Errors rough_tube = errors(cylinder(n, n / 2, 0.5, kJitter, n), on_cylinder);
    CHECK(rough_tube.curvature < 8e-2);
    CHECK(rough_tube.direction < 6.0);
    const Errors rough_pass = errors(saddle(n, kJitter, n), on_saddle);
    CHECK(rough_pass.curvature < 8e-2);
    CHECK(rough_pass.direction < 6.0);
  }
}

TEST_CASE("Gauss-Bonnet holds to 1e-9 for genus 0, 1, 2 and open surfaces, smooth and noisy") {
  const double noise = GENERATE(0.0, 0.1, 0.4);
  const std::uint64_t seed = GENERATE(1U, 2U);
  const auto characteristic = [&](const IndexedMesh& mesh) {
    return euler_characteristic(with_normal_noise(mesh, noise, seed));
  };
  CHECK(characteristic(irregular_sphere(4, 3.0, 0.4, seed)) ==
        Approx(2.0).epsilon(0.0).margin(1e-9));
  CHECK(characteristic(torus(64, 32, kMajor, kMinor)) == Approx(0.0).epsilon(0.0).margin(1e-9));
  CHECK(characteristic(pierced_block(8)) == Approx(-2.0).epsilon(0.0).margin(1e-9));
  CHECK(characteristic(sheet(30)) == Approx(1.0).epsilon(0.0).margin(1e-9));
  CHECK(characteristic(cylinder(40, 20, 0.5, kJitter, seed)) ==
        Approx(0.0).epsilon(0.0).margin(1e-9));
  CHECK(characteristic(wheel(100)) == Approx(1.0).epsilon(0.0).margin(1e-9));
}

TEST_CASE("Gaussian curvature integrates to 2 pi chi over a closed surface") {
  const auto [source, chi] =
      GENERATE(std::pair{sphere(3, 2.0), 2.0}, std::pair{torus(48, 24, kMajor, kMinor), 0.0},
               std::pair{pierced_block(6), -2.0});
  const TriangleMesh mesh = *TriangleMesh::build(with_normal_noise(source, 0.2, 3));
  const std::vector<Vec3>& x = mesh.positions();
  const CurvatureFields k = curvature(mesh, x);
  const FaceGeometry faces = face_geometry(mesh, x, smallest_area(mean_edge_length(mesh, x)));
  const std::vector<double> area = mixed_area(mesh, x, faces);
  double sum = 0.0;
  for (std::size_t v = 0; v < area.size(); ++v) sum += k.gaussian[v] * area[v];
  CHECK(sum / (2.0 * std::numbers::pi) == Approx(chi).epsilon(0.0).margin(1e-9));
}

}  // namespace fairway::test
