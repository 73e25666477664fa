// What is different about large surfaces: single precision by default, many components, long
// coordinates. Every promise of the small ones holds.

#include <cmath>

#include <catch2/catch.hpp>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/shapes.h"
#include "tests/core/generated_meshes.h"
#include "tests/core/golden_case.h"

namespace fairway::test {
namespace {

using enum Execution::Precision;

constexpr double kSingleBound = 1e-4;  // in L, after 10 steps

FlowOptions ten_steps(Method method) {
  FlowOptions options;
  options.method = method;
  options.steps = 10;
  options.step_size = 0.1;
  options.feature_angle = 30.0;
  return options;
}

/// Above the 20 000 vertices from which single precision is the default.
IndexedMesh large() {
  return with_normal_noise(octahedron(72), 0.1, 1);
}

/// Largest distance of the default run from the double-precision one, in L.
double distance_from_double(const IndexedMesh& source, const FlowOptions& options) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  REQUIRE(mesh->vertex_count() > 20'000);
  const Result<Denoised> standard = denoise(*mesh, options);
  INFO((standard ? "" : standard.error().message));
  REQUIRE(standard);
  const Result<Denoised> exact = denoise(*mesh, options, {}, {}, {.precision = double_precision});
  REQUIRE(exact);
  return largest_distance(standard->positions, exact->positions) / exact->report.mean_edge_length;
}

/// Tetrahedra with room for each: about eight edge lengths between neighbours.
IndexedMesh components(Index count) {
  return scattered_tetrahedra(count, 8.0 * std::cbrt(static_cast<double>(count)), 3);
}

void check_components(Index count) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(components(count));
  REQUIRE(mesh);
  REQUIRE(mesh->vertex_count() == 4 * std::size_t{count});
  FlowOptions options = ten_steps(Method::anisotropic_prescribed);
  options.steps = 2;
  const Result<Denoised> denoised = denoise(*mesh, options, {}, {}, {.threads = 2});
  REQUIRE(denoised);
  bool finite = true;
  for (const Vec3& p : denoised->positions) finite = finite && p.allFinite();
  CHECK(finite);
  CHECK(denoised->report.max_displacement < 2.0);
  const CurvatureFields k = curvature(*mesh, denoised->positions);
  for (std::size_t v = 0; v < k.k1.size(); ++v) {
    finite = finite && std::isfinite(k.k1[v]) && std::isfinite(k.k2[v]);
  }
  CHECK(finite);
}

}  // namespace

TEST_CASE("twenty thousand components are no trouble") {
  check_components(20'000);
  FlowOptions options = ten_steps(Method::anisotropic_prescribed);
  CHECK(distance_from_double(components(20'000), options) < kSingleBound);
}

TEST_CASE("a million components are no trouble", "[.big]") {
  check_components(1'050'000);
}

TEST_CASE("large surfaces have semi-implicit steps and the full mass matrix too") {
  FlowOptions options = ten_steps(Method::anisotropic_prescribed);
  options.steps = 1;
  SECTION("semi-implicit") {
    options.integration = Integration::semi_implicit;
  }
  SECTION("explicit, full mass") {
    options.mass = Mass::full;
  }
  CHECK(distance_from_double(large(), options) < kSingleBound);
}

TEST_CASE("single precision keeps its bound beside triangles without area") {
  // Sides split on one side only, the gap closed by a triangle of area 0, as tessellators do it.
  IndexedMesh source = large();
  for (std::size_t k = 0; k < 50; ++k) {
    const std::size_t f = 100 + 800 * k;
    const auto [a, b, c] = source.triangles[f];
    const auto m = static_cast<Index>(source.positions.size());
    source.positions.emplace_back(0.5 * (source.positions[a] + source.positions[b]));
    source.triangles[f] = {a, m, c};
    source.triangles.push_back({m, b, c});
    source.triangles.push_back({a, b, m});
  }
  for (const Method method : {Method::anisotropic, Method::anisotropic_prescribed}) {
    CHECK(distance_from_double(source, ten_steps(method)) < kSingleBound);
  }
}

TEST_CASE("single precision keeps its bound where one triangle lies far away") {
  IndexedMesh source = large();
  const double away = GENERATE(1e3, 1e5, 1e7);  // in edge lengths
  IndexedMesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  for (Vec3& p : triangle.positions) p /= 50.0;
  append(source, triangle, Vec3(away / 50.0, 0.0, 0.0));
  CHECK(distance_from_double(source, ten_steps(Method::anisotropic)) < kSingleBound);
}

TEST_CASE("a step whose size overflows is divergence, not a result") {
  // ∞ · 0 on a plane: every position becomes not-a-number.
  FlowOptions options = ten_steps(Method::mean_curvature);
  options.step_size = 1e308;
  options.guards.local_step = false;
  const auto precision = GENERATE(single_precision, double_precision);
  const TriangleMesh mesh = *TriangleMesh::build(sheet(8));
  const Result<Denoised> result = denoise(mesh, options, {}, {}, {.precision = precision});
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::diverged);
}

}  // namespace fairway::test
