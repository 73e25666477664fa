// What holds for any input: a surface or a clear refusal, finite numbers or "diverged", the same
// bits for any number of threads, and what must not move does not move.

#include <cmath>
#include <cstring>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/core.h>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/halfedge.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "core/surface_topology.h"
#include "tests/core/generated_meshes.h"
#include "tests/core/golden_case.h"
#include "tests/core/random_meshes.h"

namespace fairway::test {
namespace {

using enum Execution::Precision;

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), sizeof(Vec3)) == 0;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(),
                    [](const Vec3& p, const Vec3& q) { return same_bits(p, q); });
}

bool all_finite(const FlowReport& r) {
  bool finite = true;
  for (const double number :
       {r.mean_edge_length, r.noise, r.step_size, r.volume_before, r.volume_after, r.area_before,
        r.area_after, r.rms_displacement, r.max_displacement}) {
    finite = finite && std::isfinite(number);
  }
  for (const FlowStep& s : r.steps) {
    for (const double number :
         {s.feature_angle, s.lambda, s.displacement, s.step_size, s.solver_residual}) {
      finite = finite && std::isfinite(number);
    }
  }
  return finite;
}

/// What is wrong with the curvature at these positions; empty if nothing.
std::string wrong_curvature(const TriangleMesh& mesh, const std::vector<Vec3>& x) {
  const CurvatureFields k = curvature(mesh, x);
  for (std::size_t v = 0; v < k.k1.size(); ++v) {
    for (const double number : {k.k1[v], k.k2[v], k.mean[v], k.gaussian[v], k.predominant[v]}) {
      if (!std::isfinite(number)) return fmt::format("curvature of vertex {} is {}", v, number);
    }
    if (k.k1[v] < k.k2[v]) return fmt::format("k1 < k2 at vertex {}", v);
    for (const Vec3& d : {k.dir1[v], k.dir2[v]}) {
      const bool unit = std::abs(d.norm() - 1.0) < 1e-6 || d.isZero(0.0);
      if (!unit) return fmt::format("a direction of vertex {} has length {}", v, d.norm());
    }
  }
  return {};
}

/// What is wrong with one result; empty if nothing.
std::string wrong_result(const IndexedMesh& source, const TriangleMesh& mesh,
                         const FlowOptions& options, const Denoised& denoised) {
  const std::vector<Vec3>& x = denoised.positions;
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (!x[v].allFinite()) return fmt::format("position {} is not finite", v);
    const bool held = options.boundary == Boundary::fixed && mesh.boundary_vertex()[v] != 0;
    if (held && x[v] != mesh.positions()[v]) {
      return fmt::format("fixed vertex {} moved", v);
    }
  }
  if (!all_finite(denoised.report)) return "a number of the report is not finite";
  const std::vector<Vec3> out = mesh.scatter_positions(source, x);
  for (std::size_t s = 0; s < out.size(); ++s) {
    if (!out[s].allFinite()) return fmt::format("source position {} is not finite", s);
    const bool isolated = mesh.vertex_of_source()[s] == kNoIndex;
    const bool still = isolated || (options.method == Method::none);
    if (still && !same_bits(out[s], source.positions[s])) {
      return fmt::format("source vertex {} moved though nothing moves it", s);
    }
  }
  return wrong_curvature(mesh, x);
}

/// The first property that does not hold for one precision; empty if all do.
std::string counterexample(const IndexedMesh& source, const TriangleMesh& mesh,
                           const FlowOptions& options, Execution::Precision precision) {
  const Result<Denoised> one = denoise(mesh, options, {}, {}, {.precision = precision});
  if (!one && one.error().code != ErrorCode::diverged) return "error: " + one.error().message;
  if (one) {
    if (std::string wrong = wrong_result(source, mesh, options, *one); !wrong.empty()) return wrong;
  }
  for (const unsigned threads : {1U, 2U, 4U}) {
    const Result<Denoised> other =
        denoise(mesh, options, {}, {}, {.precision = precision, .threads = threads});
    if (static_cast<bool>(one) != static_cast<bool>(other)) {
      return fmt::format("{} threads end differently", threads);
    }
    if (one && !same_bits(one->positions, other->positions)) {
      return fmt::format("{} threads give other bits", threads);
    }
    if (!one && one.error().message != other.error().message) {
      return fmt::format("{} threads diverge differently", threads);
    }
  }
  return {};
}

/// Single precision is for lumped explicit steps.
bool may_be_single(const FlowOptions& options) {
  return options.integration == Integration::explicit_euler && options.mass != Mass::full;
}

/// The first property that a mesh breaks under these options; empty if none.
std::string counterexample(const IndexedMesh& source, const FlowOptions& options) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  if (!mesh) {
    const bool clear = mesh.error().code == ErrorCode::invalid_mesh ||
                       mesh.error().code == ErrorCode::no_triangles;
    return clear && mesh.error().message.size() > 20 ? "" : "refused without a clear reason";
  }
  if (std::string wrong = wrong_curvature(*mesh, mesh->positions()); !wrong.empty()) return wrong;
  std::string wrong = counterexample(source, *mesh, options, double_precision);
  if (!wrong.empty() || !may_be_single(options)) return wrong;
  wrong = counterexample(source, *mesh, options, single_precision);
  return wrong.empty() ? "" : "single precision: " + wrong;
}

void check_seed(std::uint64_t seed) {
  const RandomMesh random = random_mesh(seed);
  const FlowOptions options = random_options(seed);
  const std::string wrong = counterexample(random.mesh, options);
  INFO("seed " << seed << ", " << random.kind << ", " << describe(options));
  INFO(wrong);
  CHECK(wrong.empty());
}

}  // namespace

TEST_CASE("any mesh and any options give finite results, or an error, on any number of threads") {
  for (std::uint64_t seed = 0; seed < 100; ++seed) check_seed(seed);
}

TEST_CASE("rings and halfedges agree about components, boundary loops and Euler characteristic") {
  std::size_t open = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Result<TriangleMesh> mesh = TriangleMesh::build(random_mesh(seed).mesh);
    if (!mesh) continue;
    const SurfaceTopology rings = surface_topology(*mesh);
    const SurfaceTopology halfedges = halfedge_topology(*mesh);
    INFO("seed " << seed);
    CHECK(rings.components == halfedges.components);
    CHECK(rings.boundary_loops == halfedges.boundary_loops);
    CHECK(rings.euler_characteristic == halfedges.euler_characteristic);
    open += rings.boundary_loops > 1 ? 1 : 0;
  }
  CHECK(open > 20);
}

TEST_CASE("faces without area make no position jump in single precision") {
  for (const std::uint64_t seed : {109U, 448U, 582U, 1437U, 1563U}) check_seed(seed);
}

TEST_CASE("a long search finds no counterexample", "[.long]") {
  for (std::uint64_t seed = 100; seed < 5'000; ++seed) check_seed(seed);
}

TEST_CASE("PMC keeps the volume of noisy closed surfaces") {
  const std::uint64_t seed = GENERATE(1U, 2U, 3U);
  const IndexedMesh clean = GENERATE_COPY(irregular_sphere(3, 1.0, 0.3, seed), octahedron(16),
                                          torus(40, 20, 1.0, 0.4), pierced_block(6));
  const auto integration = GENERATE(Integration::explicit_euler, Integration::semi_implicit);
  const TriangleMesh mesh = *TriangleMesh::build(with_normal_noise(clean, 0.15, seed));
  FlowOptions options;
  options.integration = integration;
  const Result<Denoised> denoised = denoise(mesh, options);
  REQUIRE(denoised);
  REQUIRE_FALSE(denoised->report.steps.empty());
  const FlowReport& report = denoised->report;
  CHECK(report.volume_after == Approx(report.volume_before).epsilon(0.02));
}

TEST_CASE("single precision is close to double on random surfaces without needles") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const RandomMesh random = random_mesh(seed);
    if (random.kind != "tame") continue;
    const Result<TriangleMesh> mesh = TriangleMesh::build(random.mesh);
    REQUIRE(mesh);
    FlowOptions options = random_options(seed);
    if (!may_be_single(options)) continue;
    // The isotropic mean curvature flow is never single by default: it amplifies rounding.
    if (options.method == Method::mean_curvature) options.method = Method::anisotropic;
    options.step_size = 0.1;
    options.guards.local_step = true;
    options.steps = 5;
    options.transition = 10.0;
    options.conventions = Conventions::recommended;
    const Result<Denoised> a = denoise(*mesh, options, {}, {}, {.precision = single_precision});
    const Result<Denoised> b = denoise(*mesh, options, {}, {}, {.precision = double_precision});
    INFO("seed " << seed << ", " << random.kind << ", " << describe(options));
    REQUIRE(a);
    REQUIRE(b);
    CHECK(largest_distance(a->positions, b->positions) < 1e-4 * b->report.mean_edge_length);
  }
}

}  // namespace fairway::test
