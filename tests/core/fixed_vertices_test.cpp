// A caller's own list of vertices that do not move.

#include <algorithm>
#include <cstring>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/shapes.h"

namespace fairway::test {
namespace {

/// Every corner a vertex of its own: welding has copies to find.
IndexedMesh soup_of(const IndexedMesh& mesh) {
  IndexedMesh out;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<Index>(out.positions.size());
    for (const Index v : t) out.positions.push_back(mesh.positions[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 3) == 0;
}

IndexedMesh run(const IndexedMesh& source, const FlowOptions& options, const Execution& how = {}) {
  const TriangleMesh mesh = *TriangleMesh::build(source);
  const Result<Denoised> denoised = denoise(mesh, options, {}, {}, how);
  REQUIRE(denoised);
  return {mesh.scatter_positions(source, denoised->positions), source.triangles};
}

/// Two fans that share one place only, twelve triangles in all, and noise.
IndexedMesh bow_tie() {
  IndexedMesh one = with_normal_noise(sheet(2), 0.3, 3);
  IndexedMesh out = one;
  const Vec3 tip = one.positions.front();
  const auto offset = static_cast<Index>(one.positions.size());
  for (const Vec3& p : one.positions) out.positions.emplace_back(2.0 * tip - p);
  out.positions[offset] = tip;
  for (const Triangle& t : one.triangles) {
    out.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return out;
}

}  // namespace

TEST_CASE("a fixed vertex and its welded copies come back bit for bit from every flow") {
  IndexedMesh source = soup_of(with_normal_noise(sphere(2, 1.0), 0.2, 4));
  for (Vec3& p : source.positions) p += Vec3(1e3, 0.0, 0.0);
  const Vec3 chosen = source.positions[7];
  const bool negative_zero = GENERATE(false, true);
  for (Vec3& p : source.positions) {
    if (p == chosen && negative_zero) p = Vec3(chosen.x(), chosen.y(), -0.0);
  }
  const Vec3 fixed = source.positions[7];
  FlowOptions options;
  options.method = GENERATE(Method::mean_curvature, Method::anisotropic, Method::prescribed,
                            Method::anisotropic_prescribed);
  options.integration = GENERATE(Integration::explicit_euler, Integration::semi_implicit);
  options.steps = 4;
  options.fixed_vertices = {7};
  using enum Execution::Precision;
  for (const auto precision : {single_precision, double_precision}) {
    if (precision == single_precision && options.integration == Integration::semi_implicit)
      continue;
    const IndexedMesh moved = run(source, options, {.precision = precision});
    for (std::size_t v = 0; v < source.positions.size(); ++v) {
      if (source.positions[v] == fixed) {
        CHECK(same_bits(moved.positions[v], source.positions[v]));
      } else {
        CHECK(moved.positions[v] != source.positions[v]);
      }
    }
  }
}

TEST_CASE("both fans of a place that is no manifold stay where the place is fixed") {
  const IndexedMesh source = bow_tie();
  const TriangleMesh mesh = *TriangleMesh::build(source);
  REQUIRE(mesh.counts().split == 1);
  FlowOptions options;
  options.method = Method::mean_curvature;
  options.steps = 3;
  CHECK(run(source, options).positions[0] != source.positions[0]);
  options.fixed_vertices = {0};
  const IndexedMesh moved = run(source, options);
  CHECK(same_bits(moved.positions[0], source.positions[0]));
  CHECK(moved.positions[1] != source.positions[1]);
}

TEST_CASE("unfolding leaves fixed vertices alone") {
  IndexedMesh source = sheet(8);
  const Index folded = 40;                           // the middle of 9 × 9
  source.positions[folded] += Vec3(0.4, 0.0, 0.05);  // over its neighbour: faces are turned over
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.steps = 1;
  options.step_size = 1e-9;
  const double free = (run(source, options).positions[folded] - source.positions[folded]).norm();
  CHECK(free > 0.1);
  options.fixed_vertices = {folded};
  const IndexedMesh moved = run(source, options);
  CHECK(same_bits(moved.positions[folded], source.positions[folded]));
  CHECK(moved.positions[folded + 1] != source.positions[folded + 1]);
}

TEST_CASE("fixed vertices do not keep an automatic run from seeing that the noise is gone") {
  const IndexedMesh source = with_normal_noise(sphere(4, 1.0), 0.2, 5);
  const TriangleMesh mesh = *TriangleMesh::build(source);
  FlowOptions options;
  options.method = Method::anisotropic;
  const Result<Denoised> all = denoise(mesh, options);
  REQUIRE(all);
  for (Index v = 0; v < source.positions.size(); ++v) {
    if (source.positions[v].z() > -0.8) options.fixed_vertices.push_back(v);
  }
  REQUIRE(options.fixed_vertices.size() > source.positions.size() / 10 * 8);
  const Result<Denoised> rest = denoise(mesh, options);
  REQUIRE(rest);
  INFO(all->report.steps.size() << " steps of all, " << rest->report.steps.size()
                                << " of the rest");
  CHECK(all->report.steps.size() < 50);
  CHECK_FALSE(rest->report.steps.empty());
  CHECK(rest->report.steps.size() <= 2 * all->report.steps.size());
}

TEST_CASE("where every vertex is fixed the surface stays and the report says so") {
  const IndexedMesh source = with_normal_noise(sphere(2, 1.0), 0.2, 5);
  const TriangleMesh mesh = *TriangleMesh::build(source);
  FlowOptions options;
  for (Index v = 0; v < source.positions.size(); ++v) options.fixed_vertices.push_back(v);
  const Result<Denoised> denoised = denoise(mesh, options);
  REQUIRE(denoised);
  CHECK(denoised->positions == mesh.positions());
  CHECK(denoised->report.steps.empty());
  REQUIRE(denoised->report.notes.size() == 1);
  CHECK(denoised->report.notes[0].find("Every vertex is fixed") == 0);
}

TEST_CASE("a fixed vertex that the source does not have is refused") {
  const TriangleMesh mesh = *TriangleMesh::build(sphere(1, 1.0));
  FlowOptions options;
  options.fixed_vertices = {0, 42};
  const Result<Denoised> denoised = denoise(mesh, options);
  REQUIRE_FALSE(denoised);
  CHECK(denoised.error().code == ErrorCode::invalid_parameters);
  CHECK(denoised.error().message.find("42") != std::string::npos);
}

}  // namespace fairway::test
