// Feature vertices on request.

#include "core/features.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/edge_geometry.h"
#include "core/packed_flow.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"

namespace fairway::test {
namespace {

using enum Execution::Precision;
using Flags = std::vector<unsigned char>;

TriangleMesh noisy(const IndexedMesh& source) {
  return *TriangleMesh::build(with_normal_noise(source, 0.2, 5));
}

Denoised run(const TriangleMesh& mesh, const FlowOptions& options) {
  Result<Denoised> denoised = denoise(mesh, options, {}, {}, {.precision = double_precision});
  REQUIRE(denoised);
  return *std::move(denoised);
}

std::size_t count(const Flags& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

std::size_t differences(const Flags& a, const Flags& b) {
  REQUIRE(a.size() == b.size());
  std::size_t out = 0;
  for (std::size_t v = 0; v < a.size(); ++v) out += a[v] != b[v] ? 1 : 0;
  return out;
}

}  // namespace

TEST_CASE("the kernels take the same vertices for features as the plain operators") {
  const TriangleMesh mesh = noisy(GENERATE(sphere(3, 1.0), sheet(20), octahedron(20), ring(62, 2)));
  const double mean_edge = mean_edge_length(mesh, mesh.positions());
  const double lambda = lambda_of_feature_angle(GENERATE(25.0, 45.0), mean_edge);
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.guards.min_component = GENERATE(0, 3, 12);
  const Flags held(mesh.vertex_count());
  const Flags plain =
      feature_vertices(mesh, mesh.positions(), {lambda, options.guards.min_component});
  // Noise alone makes no group of twelve on some of these shapes, but single strong edges on all.
  if (options.guards.min_component == 0) REQUIRE(count(plain) > 0);
  REQUIRE(count(plain) < plain.size());
  for (const auto precision : {double_precision, single_precision}) {
    const auto flow = PackedFlow::create(mesh, mesh.positions(), mean_edge, held, options,
                                         {.precision = precision});
    flow->mark_start();
    REQUIRE(flow->step(lambda / mean_edge, 0.01, 1e9).in_bounds);
    // Single precision may see an edge within rounding of the threshold otherwise.
    CHECK(differences(flow->features(), plain) <= (precision == double_precision ? 0 : 2));
  }
}

TEST_CASE("features are those that the last step saw, with and without its guards") {
  const TriangleMesh mesh = noisy(octahedron(20));
  FlowOptions options;
  options.method = GENERATE(Method::anisotropic, Method::anisotropic_prescribed);
  options.integration = GENERATE(Integration::explicit_euler, Integration::semi_implicit);
  options.guards = {.unfold = false, .min_component = GENERATE(0, 12), .local_step = true};
  options.steps = 2;
  options.step_size = 0.05;
  const Denoised before = run(mesh, options);
  CHECK(before.features.empty());
  options.steps = 3;
  options.find_features = true;
  const Denoised after = run(mesh, options);
  REQUIRE(after.report.steps.size() == 3);
  const double lambda = after.report.steps.back().lambda;
  CHECK(after.report.lambda == lambda);
  const Flags expected =
      feature_vertices(mesh, before.positions, {lambda, options.guards.min_component});
  CHECK(count(expected) > 0);
  CHECK(after.features == expected);
}

TEST_CASE("without a step the features are those of the surface as it is") {
  const TriangleMesh mesh = *TriangleMesh::build(octahedron(8));
  FlowOptions options;
  options.find_features = true;
  SECTION("method none") {
    options.method = Method::none;
  }
  SECTION("zero steps") {
    options.method = Method::anisotropic_prescribed;
    options.steps = 0;
  }
  SECTION("zero steps of an isotropic flow") {
    options.method = Method::prescribed;
    options.steps = 0;
  }
  SECTION("no noise") {}
  SECTION("a given angle") {
    options.method = Method::none;
    options.feature_angle = 60.0;
  }
  const Denoised result = run(mesh, options);
  CHECK(result.positions == mesh.positions());
  CHECK(result.report.feature_angle == Approx(options.feature_angle.value_or(12.0)));
  CHECK(std::none_of(result.report.notes.begin(), result.report.notes.end(),
                     [](const std::string& note) { return note.find("not used") != note.npos; }));
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    // The edges of an octahedron about the origin lie in the coordinate planes.
    const bool on_edge = (mesh.positions()[v] + mesh.origin()).cwiseAbs().minCoeff() < 1e-9;
    CHECK((result.features[v] == 1) == on_edge);
  }
}

TEST_CASE("a feature angle above all bends finds no feature") {
  const TriangleMesh mesh = *TriangleMesh::build(octahedron(8));
  FlowOptions options;
  options.method = Method::none;
  options.find_features = true;
  options.feature_angle = 80.0;  // an octahedron's edges are bent by 70.5°
  CHECK(count(run(mesh, options).features) == 0);
}

TEST_CASE("isotropic flows take no vertex for a feature and say so") {
  const TriangleMesh mesh = noisy(octahedron(8));
  FlowOptions options;
  options.method = GENERATE(Method::mean_curvature, Method::prescribed);
  options.steps = 2;
  options.find_features = true;
  const Denoised result = run(mesh, options);
  CHECK(result.features == Flags(mesh.vertex_count()));
  REQUIRE(result.report.notes.size() == 1);
  CHECK(result.report.notes[0].find("no vertex for a feature") != std::string::npos);
}

TEST_CASE("flags go to all copies of a place and to no isolated vertex") {
  IndexedMesh source = octahedron(2);
  const Index copy = static_cast<Index>(source.positions.size());
  source.positions.push_back(source.positions[0]);
  source.positions.emplace_back(9.0, 9.0, 9.0);  // isolated
  source.triangles.front()[0] =
      source.triangles.front()[0] == 0 ? copy : source.triangles.front()[0];
  const TriangleMesh mesh = *TriangleMesh::build(source);
  const Flags gathered = gather_flags(mesh, std::vector<Index>{copy, copy + 1});
  CHECK(count(gathered) == 1);
  const Flags scattered = scatter_flags(mesh, gathered);
  CHECK(count(scattered) == 2);
  CHECK(scattered[0] == 1);
  CHECK(scattered[copy] == 1);
}

}  // namespace fairway::test
