// Bounds on the default run's error, so that quality cannot fall without a test falling.

#include <cmath>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "tests/quality/cases.h"
#include "tests/quality/noise.h"
#include "tests/quality/reference_surface.h"

namespace fairway::quality {
namespace {

Comparison after_default_run(const std::string& name, const std::string& noise) {
  const std::optional<Model> clean = model(name);
  REQUIRE(clean);
  IndexedMesh noisy = clean->mesh;
  noisy.positions = with_noise(clean->mesh, noise, 41);
  const Result<TriangleMesh> mesh = TriangleMesh::build(noisy);
  REQUIRE(mesh);
  const Result<Denoised> run = denoise(*mesh, {});
  REQUIRE(run);
  return ReferenceSurface(clean->mesh).compare(mesh->scatter_positions(noisy, run->positions));
}

/// The most degrees that the mean error of face normals may be.
struct Bound {
  std::string model, noise;
  double degrees;
};

}  // namespace

TEST_CASE("the default run stays below its error on every generated model and noise") {
  const auto bound =
      GENERATE(Bound{"made_octahedron", "n0.1", 0.12}, Bound{"made_octahedron", "n0.3", 0.35},
               Bound{"made_octahedron", "r0.2", 0.3}, Bound{"made_octahedron", "s0.2", 0.35},
               Bound{"made_ring", "n0.1", 0.3}, Bound{"made_ring", "n0.3", 0.65},
               Bound{"made_ring", "s0.2", 0.7}, Bound{"made_torus", "n0.1", 0.4},
               Bound{"made_torus", "n0.3", 0.9}, Bound{"made_hills", "n0.1", 2.4},
               Bound{"made_hills", "n0.3", 5.2}, Bound{"made_sheet", "n0.1", 0.25},
               Bound{"made_sheet", "n0.3", 0.55}, Bound{"made_sheet", "i0.5", 1.8});
  CAPTURE(bound.model, bound.noise);
  const Comparison result = after_default_run(bound.model, bound.noise);
  CHECK(result.normal_error < bound.degrees);
  CHECK(result.flipped == 0);
  CHECK(result.degenerate == 0);
  if (result.volume_change) CHECK(std::abs(*result.volume_change) < 0.5);
}

TEST_CASE("a mesh compared with itself has no error, and known changes have theirs") {
  const std::optional<Model> clean = model("made_octahedron");
  REQUIRE(clean);
  const ReferenceSurface reference(clean->mesh);
  const Comparison same = reference.compare(clean->mesh.positions);
  CHECK(same.normal_error == 0.0);
  CHECK(same.mean_distance < 1e-12);
  CHECK(same.volume_change == Approx(0.0).margin(1e-9));
  CHECK(same.flipped + same.degenerate == 0);
  std::vector<Vec3> larger = clean->mesh.positions;
  for (Vec3& p : larger) p *= 1.01;
  const Comparison grown = reference.compare(larger);
  CHECK(grown.normal_error < 1e-6);
  CHECK(*grown.volume_change == Approx(100.0 * (1.01 * 1.01 * 1.01 - 1.0)));
  // Every face of the octahedron of circumradius 1 is 1 / √3 from the centre, the diagonal is 2 √3.
  CHECK(grown.largest_distance <= Approx(0.01 / (2.0 * std::sqrt(3.0))));
  CHECK(grown.mean_distance >= 0.9 * 0.01 / std::sqrt(3.0) / (2.0 * std::sqrt(3.0)));
  std::vector<Vec3> mirrored = clean->mesh.positions;
  for (Vec3& p : mirrored) p.x() = -p.x();
  CHECK(reference.compare(mirrored).flipped == clean->mesh.triangles.size());
}

TEST_CASE("noise has the strength and the seed it is asked for") {
  const std::optional<Model> clean = model("made_torus");
  REQUIRE(clean);
  const ReferenceSurface reference(clean->mesh);
  for (const std::string_view kind : {"n", "r", "s", "d"}) {
    CAPTURE(kind);
    const std::string noise = std::string(kind) + "0.2";
    const std::vector<Vec3> once = with_noise(clean->mesh, noise, 1);
    CHECK(once == with_noise(clean->mesh, noise, 1));
    CHECK(once != with_noise(clean->mesh, noise, 2));
    double power = 0.0;
    for (std::size_t v = 0; v < once.size(); ++v) {
      power += (once[v] - clean->mesh.positions[v]).squaredNorm();
    }
    const double rms = std::sqrt(power / static_cast<double>(once.size()));
    CHECK(rms / reference.mean_edge() == Approx(0.2).epsilon(0.1));
  }
}

}  // namespace fairway::quality
