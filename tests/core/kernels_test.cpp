// The packed kernels against the plain operators.

#include <Eigen/Geometry>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/fixed_point.h"
#include "core/packed_mesh.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "tests/core/golden_case.h"
#include "tests/core/reference_flow.h"

namespace fairway::test {
namespace {

using enum Execution::Precision;

FlowOptions explicit_options(Method method, Conventions conventions) {
  FlowOptions options;
  options.method = method;
  options.steps = 5;
  options.step_size = 0.08;
  options.feature_angle = 40.0;
  options.conventions = conventions;
  options.curvature_smoothing = {.passes = 2, .fraction = 0.7};
  options.guards.unfold = false;
  return options;
}

std::vector<Vec3> run(const TriangleMesh& mesh, const FlowOptions& options, const Execution& how) {
  Result<Denoised> denoised = denoise(mesh, options, {}, {}, how);
  REQUIRE(denoised);
  return std::move(denoised->positions);
}

TriangleMesh noisy(const IndexedMesh& source) {
  Result<TriangleMesh> mesh = TriangleMesh::build(with_normal_noise(source, 0.2, 5));
  REQUIRE(mesh);
  return *std::move(mesh);
}

}  // namespace

TEST_CASE("packing keeps every vertex once, with its ring in order") {
  const TriangleMesh mesh = noisy(GENERATE(sphere(3, 1.0), sheet(20), octahedron(9), ring(30, 2)));
  const PackedMesh packed(mesh);
  std::size_t found = 0;
  for (std::size_t slot = 0; slot < packed.slot_count(); ++slot) {
    const Index v = packed.vertex_of_slot()[slot];
    const Slice& slice = packed.slices()[slot / kLanes];
    if (v == kNoIndex) continue;
    ++found;
    REQUIRE(packed.slot_of_vertex()[v] == slot);
    REQUIRE(slice.open == (mesh.boundary_vertex()[v] != 0));
    const auto ring = mesh.rings()[v];
    REQUIRE(ring.size() == slice.valence);
    for (Index k = 0; k < slice.valence; ++k) {
      const Index q = packed.ring()[kLanes * (std::size_t{slice.columns} + k) + slot % kLanes];
      CHECK(packed.vertex_of_slot()[q] == ring[k]);
    }
  }
  CHECK(found == mesh.vertex_count());
}

TEST_CASE("the kernels of every precision and instruction set do what the plain operators say") {
  const TriangleMesh mesh = noisy(GENERATE(sphere(3, 1.0), sheet(20), octahedron(9), ring(62, 2)));
  const Method method = GENERATE(Method::mean_curvature, Method::anisotropic, Method::prescribed,
                                 Method::anisotropic_prescribed);
  const Conventions conventions = GENERATE(Conventions::recommended, Conventions::paper);
  FlowOptions options = explicit_options(method, conventions);
  options.boundary = conventions == Conventions::paper ? Boundary::fixed : Boundary::free;
  options.guards.min_component = conventions == Conventions::paper ? 0 : 12;
  const double mean_edge = mean_edge_length(mesh, mesh.positions());
  const std::vector<Vec3> reference = reference_flow(mesh, options);
  for (const Isa isa : {Isa::portable, Isa::avx2, Isa::avx512}) {
    if (isa > best_isa()) continue;
    INFO(name_of(isa));
    CHECK(largest_distance(run(mesh, options, {double_precision, isa, 1}), reference) <
          1e-10 * mean_edge);
    CHECK(largest_distance(run(mesh, options, {single_precision, isa, 1}), reference) <
          1e-4 * mean_edge);
  }
}

TEST_CASE("single precision stays within 1e-4 mean edges of double where it may be the default") {
  const GoldenCase golden = load_golden(GENERATE("octa", "ring", "sheet"));
  const double mean_edge = golden.params.at("mean_edge");
  const TriangleMesh mesh = *TriangleMesh::build(golden.mesh);
  for (const auto& [name, flow] : golden.params.at("flows").items()) {
    const Json& params = flow.at("params");
    if (params.at("scheme") != "explicit" || params.at("mass") != "lumped") continue;
    if (params.at("f_mode") != "length" || params.at("flow") == "mcf") continue;
    FlowOptions options = golden_options(params, mean_edge);
    options.steps = 10;
    INFO(golden.name << " " << name);
    CHECK(largest_distance(run(mesh, options, {.precision = single_precision}),
                           run(mesh, options, {.precision = double_precision})) < 1e-4 * mean_edge);
  }
}

TEST_CASE("one, two and four threads give the same bits") {
  const TriangleMesh mesh = noisy(octahedron(60));
  const Method method = GENERATE(Method::anisotropic, Method::anisotropic_prescribed);
  const auto precision = GENERATE(single_precision, double_precision);
  FlowOptions options;
  options.method = method;
  options.steps = 5;
  const std::vector<Vec3> one = run(mesh, options, {.precision = precision, .threads = 1});
  CHECK(run(mesh, options, {.precision = precision, .threads = 2}) == one);
  CHECK(run(mesh, options, {.precision = precision, .threads = 4}) == one);
}

TEST_CASE("the difference of any two fixed-point coordinates fits 32 bits") {
  for (double largest = 0.75; largest < 1e5; largest *= 1.0 + 1.0 / 3.0) {
    for (const double extent : {largest, std::exp2(std::ceil(std::log2(largest)))}) {
      CHECK(2.0 * extent / fixed_point_unit(extent) < 2147483647.0);
    }
  }
  CHECK(2.0 * kMostFixedPointUnits < 2147483647.0);
}

TEST_CASE("fixed-point coordinates make room for a surface that grows") {
  const TriangleMesh mesh = noisy(octahedron(12));
  FlowOptions options = explicit_options(Method::mean_curvature, Conventions::recommended);
  options.guards.local_step = false;
  options.step_size = 30.0;
  options.steps = 1;
  const std::vector<Vec3> single = run(mesh, options, {.precision = single_precision});
  double largest = 0.0;
  for (const Vec3& p : single) largest = std::max(largest, p.norm());
  CHECK(largest > 9.0);  // twice the range the start needs, and more
  const double mean_edge = mean_edge_length(mesh, mesh.positions());
  CHECK(largest_distance(single, run(mesh, options, {.precision = double_precision})) <
        1e-3 * mean_edge);
}

}  // namespace fairway::test
