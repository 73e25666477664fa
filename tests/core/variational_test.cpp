// What the variational method promises.

#include "core/variational.h"

#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "tests/core/random_meshes.h"

namespace fairway::test {
namespace {

TriangleMesh built(const IndexedMesh& source) {
  Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  return *std::move(mesh);
}

VariationalResult run(const TriangleMesh& mesh, std::vector<unsigned char> held = {}) {
  held.resize(mesh.vertex_count());
  Result<VariationalResult> result = denoise_variational(mesh, held);
  REQUIRE(result);
  return *std::move(result);
}

IndexedMesh denoised(const IndexedMesh& source) {
  const TriangleMesh mesh = built(source);
  return {mesh.scatter_positions(source, run(mesh).positions), source.triangles};
}

double error_after(const IndexedMesh& clean, double noise) {
  return mean_normal_error(clean, denoised(with_normal_noise(clean, noise, 7)));
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0.0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, (a[v] - b[v]).norm());
  return most;
}

}  // namespace

TEST_CASE("the variational method removes the noise of shapes with sharp edges almost wholly") {
  for (const double noise : {0.1, 0.2, 0.3}) {
    CAPTURE(noise);
    CHECK(error_after(octahedron(32), noise) < 0.3);
    CHECK(error_after(ring(186, 4), noise) < 0.6);
  }
}

TEST_CASE("the variational method beats the automatic flow on sharp and on smooth shapes") {
  for (const IndexedMesh& clean : {octahedron(32), ring(186, 4), sphere(5, 1.0)}) {
    const IndexedMesh noisy = with_normal_noise(clean, 0.2, 3);
    const TriangleMesh mesh = built(noisy);
    const auto flow = denoise(mesh, {});
    REQUIRE(flow);
    const IndexedMesh by_flow{mesh.scatter_positions(noisy, flow->positions), noisy.triangles};
    CHECK(mean_normal_error(clean, denoised(noisy)) < mean_normal_error(clean, by_flow));
  }
}

TEST_CASE("the variational method keeps the volume") {
  for (const IndexedMesh& clean : {octahedron(32), ring(186, 4), sphere(5, 1.0)}) {
    const TriangleMesh mesh = built(with_normal_noise(clean, 0.2, 3));
    const double before = enclosed_volume(mesh, mesh.positions());
    const double after = enclosed_volume(mesh, run(mesh).positions);
    CHECK(std::abs(after / before - 1.0) < 0.005);
  }
}

TEST_CASE("the noise that the variational method finds is that which was added") {
  for (const double noise : {0.1, 0.2, 0.3}) {
    const TriangleMesh mesh = built(with_normal_noise(sphere(5, 1.0), noise, 5));
    CAPTURE(noise);
    CHECK(run(mesh).report.noise / mesh.mean_edge_length() == Approx(noise).epsilon(0.12));
  }
}

TEST_CASE("the answer of the variational method is the iterate of the least cross-validation") {
  const VariationalReport report = run(built(with_normal_noise(octahedron(16), 0.2, 1))).report;
  REQUIRE(report.chosen >= 1);
  const auto chosen = static_cast<std::size_t>(report.chosen - 1);
  for (std::size_t i = 0; i < report.path.size(); ++i) {
    CHECK(report.path[i].step == static_cast<int>(i) + 1);
    CHECK(report.path[i].gcv >= report.path[chosen].gcv);
    if (i > 0) CHECK(report.path[i].mu == 2.0 * report.path[i - 1].mu);
  }
}

TEST_CASE("the variational method gives the same bits twice, at any scale and place the same") {
  const IndexedMesh source = with_normal_noise(octahedron(12), 0.2, 9);
  const TriangleMesh mesh = built(source);
  const std::vector<Vec3> once = run(mesh).positions;
  CHECK(largest_distance(once, run(mesh).positions) == 0.0);
  IndexedMesh other = source;
  for (Vec3& p : other.positions) p = 1024.0 * p + Vec3(4096.0, -512.0, 64.0);
  const TriangleMesh moved = built(other);
  std::vector<Vec3> back = run(moved).positions;
  for (Vec3& p : back) p /= 1024.0;
  CHECK(largest_distance(once, back) < 1e-6 * mesh.mean_edge_length());
}

TEST_CASE("vertices that are held stay bit for bit, and their neighbours do not part from them") {
  const IndexedMesh clean = sheet(30);
  const TriangleMesh mesh = built(with_normal_noise(clean, 0.2, 2));
  std::vector<unsigned char> held(mesh.boundary_vertex().begin(), mesh.boundary_vertex().end());
  const VariationalResult result = run(mesh, held);
  for (std::size_t v = 0; v < held.size(); ++v) {
    if (held[v]) CHECK(result.positions[v] == mesh.positions()[v]);
  }
  CHECK(largest_distance(result.positions, mesh.positions()) < mesh.mean_edge_length());
}

TEST_CASE("the variational method takes any surface that can be built") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto mesh = TriangleMesh::build(random_mesh(seed).mesh);
    if (!mesh) continue;
    CAPTURE(seed);
    const VariationalResult result = run(*mesh);
    for (const Vec3& p : result.positions) REQUIRE(p.allFinite());
  }
}

TEST_CASE("the variational method can be canceled between iterates") {
  const TriangleMesh mesh = built(with_normal_noise(octahedron(8), 0.2, 1));
  const std::vector<unsigned char> held(mesh.vertex_count());
  std::stop_source stop;
  const auto result = denoise_variational(
      mesh, held,
      [&](const VariationalStep& step) {
        CHECK(step.step <= 3);
        if (step.step == 3) stop.request_stop();
      },
      stop.get_token());
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::canceled);
}

}  // namespace fairway::test
