// What the flows promise.

#include "core/denoise.h"

#include <Eigen/Geometry>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/normals.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"

namespace fairway::test {
namespace {

struct Outcome {
  IndexedMesh mesh;
  FlowReport report;
};

Outcome run(const IndexedMesh& source, const FlowOptions& options) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  Result<Denoised> denoised = denoise(*mesh, options);
  REQUIRE(denoised);
  return {{mesh->scatter_positions(source, denoised->positions), source.triangles},
          std::move(denoised->report)};
}

FlowOptions plain(Method method, int steps, double angle) {
  FlowOptions options;
  options.method = method;
  options.steps = steps;
  options.step_size = 0.1;
  options.feature_angle = angle;
  options.guards = {.unfold = false, .min_component = 0, .local_step = false};
  return options;
}

double volume_change(const FlowReport& report) {
  return report.volume_after / report.volume_before - 1.0;
}

double largest_move(const IndexedMesh& a, const IndexedMesh& b) {
  double most = 0.0;
  for (std::size_t v = 0; v < a.positions.size(); ++v) {
    most = std::max(most, (a.positions[v] - b.positions[v]).norm());
  }
  return most;
}

}  // namespace

TEST_CASE("PMC holds the noisy ring of Fig. 5, AMC is seen to lose it") {
  const IndexedMesh clean = ring(220, 7);
  const IndexedMesh noisy = with_normal_noise(clean, 0.2, 1);
  const Outcome held = run(noisy, plain(Method::anisotropic_prescribed, 50, 35.0));
  CHECK(std::abs(volume_change(held.report)) < 0.005);
  CHECK(mean_normal_error(clean, held.mesh) < 3.0);
  const Outcome lost = run(noisy, plain(Method::anisotropic, 50, 35.0));
  CHECK(volume_change(lost.report) < -0.05);
}

TEST_CASE("over 200 steps PMC still holds the ring and AMC loses half of it") {
  const IndexedMesh clean = ring(220, 7);
  const IndexedMesh noisy = with_normal_noise(clean, 0.2, 1);
  const Outcome held = run(noisy, plain(Method::anisotropic_prescribed, 200, 35.0));
  CHECK(std::abs(volume_change(held.report)) < 0.005);
  CHECK(mean_normal_error(clean, held.mesh) < 3.0);
  const Outcome lost = run(noisy, plain(Method::anisotropic, 200, 35.0));
  CHECK(volume_change(lost.report) < -0.5);
}

TEST_CASE("a clean sphere stays put under PMC, eq. (9)") {
  const IndexedMesh source = sphere(3, 1.0);
  for (const Method method : {Method::prescribed, Method::anisotropic_prescribed}) {
    const Outcome outcome = run(source, plain(method, 100, 35.0));
    CHECK(std::abs(volume_change(outcome.report)) < 1e-4);
  }
}

TEST_CASE("a sphere shrinks at its rate under mean curvature flow") {
  // dr/dt = −2/r with the paper's H = k1 + k2 and step s: r² falls by 4 s per step.
  const IndexedMesh source = sphere(4, 1.0);
  const Outcome outcome = run(source, plain(Method::mean_curvature, 20, 35.0));
  const double s = 0.1 * std::pow(outcome.report.mean_edge_length, 2);
  const double radius = std::sqrt(1.0 - 4.0 * 20.0 * s);
  CHECK(outcome.mesh.positions[7].norm() == Approx(radius).epsilon(1e-3));
}

TEST_CASE("a plane is fixed by every flow, its boundary too") {
  const IndexedMesh source = sheet(10);
  for (const Method method : {Method::mean_curvature, Method::anisotropic, Method::prescribed,
                              Method::anisotropic_prescribed}) {
    CHECK(largest_move(source, run(source, plain(method, 10, 35.0)).mesh) < 1e-13);
  }
}

TEST_CASE("the automatic run removes noise and keeps features without any parameter") {
  const double strength = GENERATE(0.1, 0.2, 0.3);
  const IndexedMesh clean = octahedron(32);
  const IndexedMesh noisy = with_normal_noise(clean, strength, 11);
  const double before = mean_normal_error(clean, noisy);
  for (const Method method : {Method::anisotropic, Method::anisotropic_prescribed}) {
    FlowOptions options;
    options.method = method;
    const Outcome outcome = run(noisy, options);
    CHECK(mean_normal_error(clean, outcome.mesh) < 0.25 * before);
    CHECK(std::abs(volume_change(outcome.report)) < 0.01);
    CHECK(outcome.report.noise == Approx(strength).epsilon(0.15));
    CHECK(outcome.report.steps.size() <= 100);
  }
}

TEST_CASE("an automatic run leaves clean surfaces as they are and says so") {
  const IndexedMesh source =
      GENERATE(sphere(3, 2.0), torus(48, 24, 1.0, 0.4), ring(220, 7), octahedron(8), sheet(8));
  FlowOptions options;
  options.method = GENERATE(Method::variational, Method::anisotropic_prescribed);
  const Outcome outcome = run(source, options);
  CHECK(outcome.mesh.positions == source.positions);
  REQUIRE(outcome.report.notes.size() == 1);
  CHECK(outcome.report.notes[0].find("No noise") == 0);
}

TEST_CASE("fixed boundaries do not move, free ones may") {
  const IndexedMesh source = with_normal_noise(sheet(8), 0.2, 3);
  FlowOptions options = plain(Method::anisotropic, 5, 60.0);
  options.boundary = Boundary::fixed;
  const Outcome outcome = run(source, options);
  const TriangleMesh mesh = *TriangleMesh::build(source);
  for (std::size_t v = 0; v < source.positions.size(); ++v) {
    const bool moved = outcome.mesh.positions[v] != source.positions[v];
    CHECK(moved == (mesh.boundary_vertex()[v] == 0));
  }
}

TEST_CASE("the result scales with the mesh and does not care where it lies") {
  const IndexedMesh source = with_normal_noise(ring(62, 2), 0.2, 2);
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.steps = 10;
  const IndexedMesh reference = run(source, options).mesh;
  const double scale = GENERATE(1e-3, 1e3);
  IndexedMesh moved = source;
  for (Vec3& p : moved.positions) p = scale * p;
  IndexedMesh back = run(moved, options).mesh;
  for (Vec3& p : back.positions) p /= scale;
  CHECK(largest_move(reference, back) < 1e-9);
}

TEST_CASE("zero steps and method none return the input bit for bit") {
  IndexedMesh source = with_normal_noise(sphere(2, 1.0), 0.3, 4);
  for (Vec3& p : source.positions) p += Vec3(1e5, 0.0, 0.0);
  FlowOptions none;
  none.method = Method::none;
  CHECK(run(source, none).mesh.positions == source.positions);
  FlowOptions zero;
  zero.method = Method::anisotropic_prescribed;
  zero.steps = 0;
  CHECK(run(source, zero).mesh.positions == source.positions);
}

TEST_CASE("without the local step a needle mesh diverges and says so, with it all stays finite") {
  IndexedMesh source = with_normal_noise(sheet(12), 0.1, 6);
  for (Vec3& p : source.positions) p.x() *= 1e-3;
  FlowOptions options = plain(Method::mean_curvature, 400, 35.0);
  options.step_size = 10.0;
  const TriangleMesh mesh = *TriangleMesh::build(source);
  const Result<Denoised> wild = denoise(mesh, options);
  REQUIRE_FALSE(wild);
  CHECK(wild.error().code == ErrorCode::diverged);
  CHECK(wild.error().message.find("at step ") != std::string::npos);
  CHECK(wild.error().message.find("ten bounding boxes") != std::string::npos);
  options.guards.local_step = true;
  CHECK(denoise(mesh, options));
}

TEST_CASE("a step to what is no number says so, and which step it was") {
  const TriangleMesh mesh = *TriangleMesh::build(with_normal_noise(sphere(2, 1.0), 0.2, 4));
  FlowOptions options = plain(Method::anisotropic_prescribed, 5, 35.0);
  using enum Execution::Precision;
  const auto precision = GENERATE(single_precision, double_precision);
  options.step_size = precision == single_precision ? 1e38 : 1e308;
  const Result<Denoised> wild = denoise(mesh, options, {}, {}, {.precision = precision});
  REQUIRE_FALSE(wild);
  CHECK(wild.error().code == ErrorCode::diverged);
  CHECK(wild.error().message.find("at step 1: a position is not a finite number") !=
        std::string::npos);
}

TEST_CASE("progress comes after each step and a stop ends the run between two") {
  const TriangleMesh mesh = *TriangleMesh::build(with_normal_noise(sphere(2, 1.0), 0.2, 4));
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.steps = 50;
  std::stop_source stop;
  std::vector<int> seen;
  const Result<Denoised> result = denoise(
      mesh, options,
      [&](const FlowStep& step) {
        seen.push_back(step.step);
        CHECK(step.of == 50);
        if (step.step == 3) stop.request_stop();
      },
      stop.get_token());
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::canceled);
  CHECK(seen == std::vector<int>{1, 2, 3});
}

TEST_CASE("normals keep hard edges hard and seams smooth") {
  // Two coplanar triangles over a seam (equal normals), one upright triangle at a hard edge.
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0},   {0, 1, 0},   // flat
                    {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0},   // flat, other side of the seam
                    {0, 0, 0}, {0, 0, -1},  {1, 0, 0}};  // upright
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const std::vector<Index> place = {0, 1, 2, 1, 3, 2, 0, 4, 1};
  const Vec3 up(0, 0, 1);
  const Vec3 out(0, -1, 0);
  const std::vector<Vec3> normals =
      keep_split_normals(mesh.positions, mesh.triangles, place,
                         std::vector<Vec3>{up, up, up, up, up, up, out, out, out});
  CHECK((normals[1] - normals[3]).norm() < 1e-15);
  CHECK((normals[0] - up).norm() < 1e-15);
  CHECK(normals[1] != up);
  CHECK((normals[8] - out).norm() < 1e-12);
}

}  // namespace fairway::test
