// The same surface written down differently gives the same answer.
//
// In exact arithmetic all of these are equalities; what differs is rounding, and what a flow makes
// of it. A coordinate relative to the centroid is rounded by at most 2^-53 of the size of the mesh:
// 1e-14 L on these meshes, some 50 L across. Stable steps damp the Laplacian part, and the weights,
// Lipschitz with constants of order r, amplify the rest by a small factor per step: 1e-12 L is the
// largest difference measured, kSame leaves a factor of 100. The choices that are not continuous
// (feature or not, small group or not, when an automatic run stops) would show as 1e-3 L and more;
// some edge of these meshes lies within 1e-14 of a threshold with a probability of about 1e-10, and
// the seeds are fixed.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/shapes.h"
#include "tests/core/generated_meshes.h"
#include "tests/core/golden_case.h"

namespace fairway::test {
namespace {

constexpr double kSame = 1e-9;        // in L
constexpr double kSameSingle = 1e-4;  // in L: the promise of the single-precision path

struct Run {
  std::vector<Vec3> displacement;  ///< per source vertex
  FlowReport report;
};

Run run(const IndexedMesh& source, const FlowOptions& options) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  Result<Denoised> denoised = denoise(*mesh, options);
  INFO((denoised ? "" : denoised.error().message));
  REQUIRE(denoised);
  Run out{{}, std::move(denoised->report)};
  REQUIRE_FALSE(out.report.steps.empty());
  for (const Index v : mesh->vertex_of_source()) {
    out.displacement.emplace_back(denoised->positions[v] - mesh->positions()[v]);
  }
  return out;
}

/// A closed surface with features and an open one side by side, noisy; every coordinate a multiple
/// of 2^-30, so that far offsets by powers of two are exact.
IndexedMesh subject() {
  IndexedMesh mesh = octahedron(14);
  append(mesh, saddle(16, 0.2, 3), Vec3(3.0, 0.5, 0.25));
  mesh = with_normal_noise(mesh, 0.15, 8);
  for (Vec3& p : mesh.positions) p = (p * 0x1p30).array().round().matrix() * 0x1p-30;
  return mesh;
}

FlowOptions flow(Method method, Integration integration, bool automatic) {
  FlowOptions options;
  options.method = method;
  options.integration = integration;
  if (automatic) return options;
  options.steps = 10;
  options.step_size = 0.05;
  options.feature_angle = 25.0;
  options.curvature_smoothing = {.passes = 2, .fraction = 0.7};
  return options;
}

FlowOptions any_flow() {
  const Method method = GENERATE(Method::anisotropic, Method::anisotropic_prescribed);
  const Integration integration = GENERATE(Integration::explicit_euler, Integration::semi_implicit);
  const bool automatic = GENERATE(false, true);
  return flow(method, integration, automatic);
}

Eigen::Affine3d rigid_motion() {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.translate(Vec3(0.3, -7.1, 2.2));
  map.rotate(Eigen::AngleAxisd(1.1, Vec3(1.0, 2.0, -0.5).normalized()));
  return map;
}

/// Same steps, and volumes, areas and displacements in proportion.
void check_reports(const FlowReport& a, const FlowReport& b, double scale) {
  CHECK(b.steps.size() == a.steps.size());
  CHECK(b.mean_edge_length == Approx(scale * a.mean_edge_length).epsilon(1e-12));
  CHECK(b.noise == Approx(a.noise).epsilon(1e-9));
  CHECK(b.area_after == Approx(scale * scale * a.area_after).epsilon(1e-9));
  CHECK(b.rms_displacement == Approx(a.rms_displacement).epsilon(1e-9));
  CHECK(b.flipped_faces == a.flipped_faces);
  CHECK(b.unfold_rounds == a.unfold_rounds);
}

/// max | k_b · scale − k_a | over k1, k2, mean and Gaussian curvature, in units of 1/L, 1/L².
double largest_difference_of_curvature(const CurvatureFields& a, const CurvatureFields& b,
                                       double scale, double mean_edge) {
  double most = 0.0;
  for (std::size_t v = 0; v < a.k1.size(); ++v) {
    const double l = mean_edge;
    most = std::max({most, l * std::abs(scale * b.k1[v] - a.k1[v]),
                     l * std::abs(scale * b.k2[v] - a.k2[v]),
                     l * std::abs(scale * b.mean[v] - a.mean[v]),
                     l * l * std::abs(scale * scale * b.gaussian[v] - a.gaussian[v])});
  }
  return most;
}

CurvatureFields curvature_of(const IndexedMesh& source) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  return scatter(*mesh, curvature(*mesh, mesh->positions()));
}

/// Axes turn with the surface where the two curvatures differ by more than 1e-4 / L (rounding turns
/// them by its ratio to that difference); their sign is free.
double largest_turn(const CurvatureFields& a, const CurvatureFields& b,
                    const Eigen::Matrix3d& rotation, double mean_edge) {
  double most = 0.0;
  for (std::size_t v = 0; v < a.dir1.size(); ++v) {
    if ((a.k1[v] - a.k2[v]) * mean_edge < 1e-4) continue;
    most = std::max(most, (rotation * a.dir1[v]).cross(b.dir1[v]).norm());
  }
  return most;
}

}  // namespace

TEST_CASE("flows turn and move with the surface") {
  const FlowOptions options = any_flow();
  const IndexedMesh source = subject();
  const Eigen::Affine3d map = rigid_motion();
  const Run still = run(source, options);
  Run moved = run(transformed(source, map), options);
  for (Vec3& d : moved.displacement) d = map.rotation().transpose() * d;
  const double mean_edge = still.report.mean_edge_length;
  CHECK(largest_distance(still.displacement, moved.displacement) < kSame * mean_edge);
  check_reports(still.report, moved.report, 1.0);
}

TEST_CASE("flows scale with the surface, from 1e-3 to 1e3 and far beyond") {
  const FlowOptions options = any_flow();
  const IndexedMesh source = subject();
  const Run one = run(source, options);
  for (const double scale : {1e-3, 1e3, 1e-12, 1e12}) {
    Run scaled = run(transformed(source, Eigen::Affine3d(Eigen::Scaling(scale))), options);
    for (Vec3& d : scaled.displacement) d /= scale;
    CHECK(largest_distance(one.displacement, scaled.displacement) <
          kSame * one.report.mean_edge_length);
    check_reports(one.report, scaled.report, scale);
  }
}

TEST_CASE("flows do not care that the surface lies a million lengths away") {
  // Edges of length about 1. 2^20 ≈ 1e6 keeps every coordinate exact, so the bound is that of the
  // other tests; 1e6 and a third rounds coordinates by 6e-11, amplified like any perturbation.
  const FlowOptions options = any_flow();
  IndexedMesh source = transformed(subject(), Eigen::Affine3d(Eigen::Scaling(8.0)));
  const Run near = run(source, options);
  const double mean_edge = near.report.mean_edge_length;
  for (const auto& [offset, bound] : {std::pair{0x1p20, kSame}, {1e6 + 1.0 / 3.0, 1e-7}}) {
    const Eigen::Affine3d map(Eigen::Translation3d(offset, -offset, offset));
    const Run far = run(transformed(source, map), options);
    CHECK(largest_distance(near.displacement, far.displacement) < bound * mean_edge);
    CHECK(far.report.steps.size() == near.report.steps.size());
    CHECK(far.report.volume_after == Approx(near.report.volume_after).epsilon(bound));
  }
}

TEST_CASE("flows do not care how vertices, triangles and corners are ordered") {
  const FlowOptions options = any_flow();
  const IndexedMesh source = subject();
  const Run plain = run(source, options);
  const Relabelled other = relabelled(source, 21);
  const Run shuffled = run(other.mesh, options);
  CHECK(largest_distance(plain.displacement, other.in_old_order(shuffled.displacement)) <
        kSame * plain.report.mean_edge_length);
  check_reports(plain.report, shuffled.report, 1.0);
}

TEST_CASE("turning the corners of triangles changes no bit") {
  // Rings, and with them every sum, start at a vertex's first face, whatever its corners' order;
  // only the order of faces could matter, and it stays.
  const FlowOptions options = any_flow();
  const IndexedMesh source = subject();
  IndexedMesh turned = source;
  for (Triangle& t : turned.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  const Run plain = run(source, options);
  const Run other = run(turned, options);
  CHECK(plain.displacement == other.displacement);
}

TEST_CASE("a large surface keeps its answer within the promise of single precision") {
  // Above 20 000 vertices positions are fixed-point and sums single: every way to write the
  // surface down rounds differently, and each result is within 1e-4 L of the exact one, so that two
  // of them are within 2e-4 L.
  const Method method = GENERATE(Method::anisotropic, Method::anisotropic_prescribed);
  const FlowOptions options = flow(method, Integration::explicit_euler, false);
  const IndexedMesh source = with_normal_noise(octahedron(72), 0.15, 4);
  REQUIRE(source.positions.size() > 20'000);
  const Run plain = run(source, options);
  const double bound = 2.0 * kSameSingle * plain.report.mean_edge_length;
  const Relabelled other = relabelled(source, 5);
  CHECK(largest_distance(plain.displacement,
                         other.in_old_order(run(other.mesh, options).displacement)) < bound);
  const Eigen::Affine3d map = rigid_motion();
  Run moved = run(transformed(source, map), options);
  for (Vec3& d : moved.displacement) d = map.rotation().transpose() * d;
  CHECK(largest_distance(plain.displacement, moved.displacement) < bound);
  for (const double scale : {1e-3, 1e3}) {
    Run scaled = run(transformed(source, Eigen::Affine3d(Eigen::Scaling(scale))), options);
    for (Vec3& d : scaled.displacement) d /= scale;
    CHECK(largest_distance(plain.displacement, scaled.displacement) < bound);
  }
  const double unit = 1.0 / plain.report.mean_edge_length;
  const Eigen::Affine3d away = Eigen::Translation3d(1e6, 1e6, 1e6) * Eigen::Scaling(unit);
  Run far = run(transformed(source, away), options);
  for (Vec3& d : far.displacement) d /= unit;
  CHECK(largest_distance(plain.displacement, far.displacement) < bound);
}

TEST_CASE("curvature turns with the surface and scales with one over length") {
  const IndexedMesh source = subject();
  const double mean_edge =
      run(source, flow(Method::anisotropic, {}, false)).report.mean_edge_length;
  const CurvatureFields plain = curvature_of(source);
  const Eigen::Affine3d motion = rigid_motion();
  const CurvatureFields moved = curvature_of(transformed(source, motion));
  CHECK(largest_difference_of_curvature(plain, moved, 1.0, mean_edge) < kSame);
  CHECK(largest_turn(plain, moved, motion.rotation(), mean_edge) < 1e-8);
  for (const double scale : {1e-3, 1e3, 1e-12, 1e12}) {
    const Eigen::Affine3d map(Eigen::Scaling(scale));
    const CurvatureFields scaled = curvature_of(transformed(source, map));
    CHECK(largest_difference_of_curvature(plain, scaled, scale, mean_edge) < kSame);
    CHECK(largest_turn(plain, scaled, Eigen::Matrix3d::Identity(), mean_edge) < 1e-8);
  }
}

TEST_CASE("curvature does not care where the surface lies nor how it is ordered") {
  const IndexedMesh source = subject();
  const double mean_edge =
      run(source, flow(Method::anisotropic, {}, false)).report.mean_edge_length;
  const CurvatureFields plain = curvature_of(source);
  const Eigen::Affine3d map(Eigen::Translation3d(0x1p20, 0x1p20, -0x1p20));
  const CurvatureFields far = curvature_of(transformed(source, map));
  CHECK(largest_difference_of_curvature(plain, far, 1.0, mean_edge) < kSame);
  CHECK(largest_turn(plain, far, Eigen::Matrix3d::Identity(), mean_edge) < 1e-8);

  const Relabelled other = relabelled(source, 22);
  CurvatureFields shuffled = curvature_of(other.mesh);
  CurvatureFields back = shuffled;
  for (std::size_t v = 0; v < other.new_of_old.size(); ++v) {
    const Index w = other.new_of_old[v];
    back.k1[v] = shuffled.k1[w];
    back.k2[v] = shuffled.k2[w];
    back.mean[v] = shuffled.mean[w];
    back.gaussian[v] = shuffled.gaussian[w];
  }
  back.dir1 = other.in_old_order(shuffled.dir1);
  CHECK(largest_difference_of_curvature(plain, back, 1.0, mean_edge) < kSame);
  CHECK(largest_turn(plain, back, Eigen::Matrix3d::Identity(), mean_edge) < 1e-8);
}

}  // namespace fairway::test
