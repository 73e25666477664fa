// What the variational method promises.

#include "core/variational.h"

#include <cmath>
#include <functional>
#include <string>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "tests/core/generated_meshes.h"
#include "tests/core/random_meshes.h"

namespace fairway::test {
namespace {

TriangleMesh built(const IndexedMesh& source) {
  Result<TriangleMesh> mesh = TriangleMesh::build(source);
  REQUIRE(mesh);
  return *std::move(mesh);
}

VariationalResult run(const TriangleMesh& mesh, std::vector<unsigned char> held = {},
                      const VariationalOptions& options = {}) {
  held.resize(mesh.vertex_count());
  Result<VariationalResult> result = denoise_variational(mesh, held, options);
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

/// Every vertex moved along the direction by `way` of its number.
IndexedMesh moved_by(const IndexedMesh& mesh, const std::function<Vec3(Index)>& way) {
  IndexedMesh out = mesh;
  for (Index v = 0; v < out.positions.size(); ++v) out.positions[v] += way(v);
  return out;
}

/// Noise of standard deviation `strength` mean edges along the normals that neighbours share: white
/// noise averaged once with the mean of the ring.
IndexedMesh with_smooth_noise(const IndexedMesh& clean, double strength, std::uint64_t seed) {
  const TriangleMesh mesh = built(clean);
  const FaceGeometry faces = face_geometry(mesh, mesh.positions(), 0.0);
  const std::vector<Vec3> normals = vertex_normals(mesh, faces);
  const IndexedMesh white = with_normal_noise(clean, 1.0, seed);
  std::vector<double> noise(normals.size());
  for (std::size_t v = 0; v < noise.size(); ++v) {
    noise[v] = (white.positions[v] - clean.positions[v]).dot(normals[v]);
  }
  std::vector<double> smooth(noise.size());
  double power = 0.0;
  for (std::size_t v = 0; v < noise.size(); ++v) {
    double sum = 0.0;
    for (const Index w : mesh.rings()[v]) sum += noise[w];
    smooth[v] = 0.5 * (noise[v] + sum / static_cast<double>(mesh.rings()[v].size()));
    power += smooth[v] * smooth[v];
  }
  const double factor =
      strength * mesh.mean_edge_length() / std::sqrt(power / static_cast<double>(noise.size()));
  return moved_by(clean, [&](Index v) { return Vec3(factor * smooth[v] * normals[v]); });
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
    FlowOptions options;
    options.method = Method::anisotropic_prescribed;
    const auto flow = denoise(mesh, options);
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
  CHECK(report.kind == FoundNoise::white);
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

TEST_CASE("what is held is a condition of the minimum, not put back afterwards") {
  IndexedMesh lifted = sheet(30);
  const TriangleMesh flat = built(lifted);
  const double edge = flat.mean_edge_length();
  lifted = with_normal_noise(lifted, 0.1, 2);
  for (std::size_t v = 0; v < lifted.positions.size(); ++v) {
    if (lifted.positions[v].head<2>().cwiseAbs().maxCoeff() > 0.99) {
      lifted.positions[v].z() += 0.5 * edge;
    }
  }
  const TriangleMesh mesh = built(lifted);
  const auto height_beside = [&](const VariationalResult& result) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      if (mesh.boundary_vertex()[v]) continue;
      for (const Index w : mesh.rings()[v]) {
        if (!mesh.boundary_vertex()[w]) continue;
        sum += result.positions[v].z() + mesh.origin().z();
        ++count;
      }
    }
    return sum / count / edge;
  };
  const std::vector<unsigned char> held(mesh.boundary_vertex().begin(),
                                        mesh.boundary_vertex().end());
  VariationalOptions options;
  options.strength = 0.6;
  CAPTURE(height_beside(run(mesh, held, options)), height_beside(run(mesh, {}, options)));
  CHECK(std::abs(height_beside(run(mesh, held, options)) - height_beside(run(mesh, {}, options))) >
        0.02);
}

TEST_CASE("the least cross-validation is chosen where it lies in the middle of the path, too") {
  IndexedMesh hills = sphere(5, 1.0);
  for (Vec3& p : hills.positions) {
    p *= 1.0 + 0.1 * std::sin(5.0 * p.x()) * std::cos(4.0 * p.y()) + 0.03 * std::sin(21.0 * p.z());
  }
  VariationalOptions options;
  options.surface = SurfaceKind::sharp;
  const VariationalReport report = run(built(with_normal_noise(hills, 0.1, 1)), {}, options).report;
  REQUIRE(report.chosen >= 1);
  const double least = report.path[static_cast<std::size_t>(report.chosen) - 1].gcv;
  CHECK(report.chosen < static_cast<int>(report.path.size()));
  for (const VariationalStep& step : report.path) CHECK(step.gcv >= least);
}

TEST_CASE("the variational method takes any surface that can be built") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto mesh = TriangleMesh::build(random_mesh(seed).mesh);
    if (!mesh) continue;
    CAPTURE(seed);
    VariationalOptions whole_path;
    whole_path.strength = 1.0;
    VariationalOptions correlated;
    correlated.noise = NoiseKind::correlated;
    for (const VariationalOptions& options : {VariationalOptions(), whole_path, correlated}) {
      const VariationalResult result = run(*mesh, {}, options);
      for (const Vec3& p : result.positions) REQUIRE(p.allFinite());
    }
  }
}

TEST_CASE("the variational method can be canceled between iterates") {
  const TriangleMesh mesh = built(with_normal_noise(octahedron(8), 0.2, 1));
  const std::vector<unsigned char> held(mesh.vertex_count());
  std::stop_source stop;
  const auto result = denoise_variational(
      mesh, held, {},
      [&](const VariationalStep& step) {
        CHECK(step.step <= 3);
        if (step.step == 3) stop.request_stop();
      },
      stop.get_token());
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::canceled);
}

TEST_CASE("noise that neighbours share is found, and removed as thoroughly") {
  for (const IndexedMesh& clean : {octahedron(32), ring(186, 4)}) {
    const IndexedMesh noisy = with_smooth_noise(clean, 0.2, 4);
    const TriangleMesh mesh = built(noisy);
    const VariationalResult result = run(mesh);
    CHECK(result.report.kind == FoundNoise::correlated);
    const auto error = [&](const VariationalResult& r) {
      return mean_normal_error(clean,
                               {mesh.scatter_positions(noisy, r.positions), noisy.triangles});
    };
    CHECK(error(result) < 0.6);
    VariationalOptions white;
    white.noise = NoiseKind::white;
    const VariationalResult taken_for_white = run(mesh, {}, white);
    CHECK(taken_for_white.report.kind == FoundNoise::white);
    CHECK(error(result) < 0.3 * error(taken_for_white));
  }
}

TEST_CASE("noise that is stronger in one place than in another is removed from both") {
  const IndexedMesh clean = octahedron(40);
  const IndexedMesh white = with_normal_noise(clean, 0.3, 8);
  const IndexedMesh noisy = moved_by(clean, [&](Index v) {
    const double share = clean.positions[v].z() > 0.0 ? 1.0 : 0.1;
    return Vec3(share * (white.positions[v] - clean.positions[v]));
  });
  CHECK(mean_normal_error(clean, denoised(noisy)) < 0.25);
}

TEST_CASE("a surface without noise comes back as it was, however it is shaped") {
  IndexedMesh two = ring(93, 2);
  append(two, sphere(4, 0.5), Vec3(4.0, 0.0, 0.0));
  for (const IndexedMesh& clean :
       {octahedron(2), octahedron(16), ring(12, 1), ring(186, 4), sphere(1, 1.0), sphere(5, 1.0),
        sheet(20), torus(60, 24, 2.0, 0.7), saddle(24, 0.2, 1), pierced_block(2), two}) {
    const TriangleMesh mesh = built(clean);
    const VariationalResult result = run(mesh);
    CHECK(result.report.kind == FoundNoise::none);
    CHECK(largest_distance(result.positions, mesh.positions()) == 0.0);
    CHECK(find_variational_noise(mesh).kind == FoundNoise::none);
  }
}

TEST_CASE("a surface without any edge is given to a low pass, one with edges never") {
  const VariationalReport smooth =
      run(built(with_normal_noise(torus(160, 60, 2.0, 0.7), 0.1, 3))).report;
  const VariationalReport sharp = run(built(with_normal_noise(octahedron(32), 0.1, 3))).report;
  CHECK(sharp.pass_band == 0.0);
  CHECK(sharp.chosen > 0);
  CHECK((smooth.pass_band > 0.0) == (smooth.chosen == 0));
}

TEST_CASE("strength goes along the path: 0 is the start, more is smoother") {
  const IndexedMesh clean = octahedron(24);
  const TriangleMesh mesh = built(with_normal_noise(clean, 0.2, 6));
  VariationalOptions options;
  double before = -1.0;
  for (const double strength : {0.0, 0.02, 0.1, 0.11, 0.25, 0.5}) {
    options.strength = strength;
    const VariationalResult result = run(mesh, {}, options);
    const double moved = largest_distance(result.positions, mesh.positions());
    CHECK(result.report.strength == strength);
    CHECK(moved > before);
    before = moved;
    if (strength == 0.0) CHECK(moved == 0.0);
  }
}

TEST_CASE("strength moves a surface that has no noise too") {
  const TriangleMesh mesh = built(sphere(4, 1.0));
  VariationalOptions options;
  options.strength = 0.9;
  CHECK(largest_distance(run(mesh, {}, options).positions, mesh.positions()) > 0.0);
}

TEST_CASE("any number of threads gives the same bits") {
  const TriangleMesh mesh = built(with_smooth_noise(ring(186, 4), 0.2, 1));
  const std::vector<Vec3> one = run(mesh).positions;
  VariationalOptions options;
  for (const unsigned threads : {2U, 3U}) {
    options.threads = threads;
    CHECK(largest_distance(one, run(mesh, {}, options).positions) == 0.0);
  }
}

TEST_CASE("the order of vertices and triangles hardly matters") {
  const IndexedMesh source = with_normal_noise(octahedron(20), 0.2, 2);
  const Relabelled other = relabelled(source, 5);
  const IndexedMesh a = denoised(source);
  const IndexedMesh b = denoised(other.mesh);
  const double edge = built(source).mean_edge_length();
  CHECK(largest_distance(a.positions, other.in_old_order(b.positions)) < 1e-3 * edge);
}

}  // namespace fairway::test
