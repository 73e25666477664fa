// The generated models are what their headers promise.

#include "tests/figures/models.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <catch2/catch.hpp>

#include "core/triangle_mesh.h"
#include "tests/figures/measures.h"
#include "tests/figures/plate.h"

using namespace fairway;

namespace {

struct Counts {
  bool every_side_has_one_partner = true;
  int euler = 0;
};

Counts count(const IndexedMesh& mesh) {
  std::map<std::pair<Index, Index>, int> sides;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  Counts out;
  for (const auto& [side, times] : sides) {
    const auto partner = sides.find({side.second, side.first});
    if (times != 1 || partner == sides.end()) out.every_side_has_one_partner = false;
  }
  out.euler = static_cast<int>(mesh.positions.size()) - static_cast<int>(sides.size() / 2) +
              static_cast<int>(mesh.triangles.size());
  return out;
}

/// Longest side over the height on it, at worst; 1.15 for an equilateral triangle.
double worst_aspect(const IndexedMesh& mesh) {
  double worst = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.positions;
    const double longest =
        std::max({(x[a] - x[b]).norm(), (x[b] - x[c]).norm(), (x[c] - x[a]).norm()});
    worst = std::max(worst, longest * longest / (x[b] - x[a]).cross(x[c] - x[a]).norm());
  }
  return worst;
}

/// No vertex is welded, split or unused when the mesh becomes a surface.
void check_clean_surface(const IndexedMesh& mesh) {
  const Result<TriangleMesh> surface = TriangleMesh::build(mesh);
  REQUIRE(surface);
  CHECK(surface->vertex_count() == mesh.positions.size());
  CHECK(surface->counts().split == 0);
  CHECK(surface->counts().degenerate_triangles == 0);
}

}  // namespace

TEST_CASE("the drilled block is closed, oriented outward, of genus one and well shaped") {
  const IndexedMesh mesh = drilled_block(0.1);
  const Counts counts = count(mesh);
  CHECK(counts.every_side_has_one_partner);
  CHECK(counts.euler == 0);
  // The hole is a polygon of 38 sides.
  const double hole = 0.5 * 38 * 0.36 * std::sin(2.0 * std::numbers::pi / 38);
  CHECK(volume_of(mesh) == Approx(0.8 * (4.0 - hole)).epsilon(1e-3));
  CHECK(worst_aspect(mesh) < 3.0);
  check_clean_surface(mesh);
}

TEST_CASE("the part with the vanishing ridge is closed, oriented outward and a ball") {
  const IndexedMesh mesh = vanishing_ridge(0.06);
  const Counts counts = count(mesh);
  CHECK(counts.every_side_has_one_partner);
  CHECK(counts.euler == 2);
  // Below the full height of 0.7 over its base, above that of its lowest wall.
  const double base = 0.5 * 130.0 / 180.0 * std::numbers::pi * (1.5 * 1.5 - 0.5 * 0.5);
  CHECK(volume_of(mesh) < 0.7 * base);
  CHECK(volume_of(mesh) > 0.55 * base);
  CHECK(worst_aspect(mesh) < 3.5);
  check_clean_surface(mesh);
}

TEST_CASE("the ridge's crease follows edges and fades from 60 degrees to none") {
  const IndexedMesh mesh = vanishing_ridge(0.06);
  std::vector<double> angles;
  angles.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) angles.push_back(vanishing_ridge_angle_at(p));
  CHECK(*std::ranges::max_element(angles) == 60.0);
  CHECK(std::ranges::any_of(angles, [](double angle) { return angle > 0.0 && angle < 5.0; }));
  // The bend measured across the edges of the ridge is the angle promised there.
  const Result<TriangleMesh> surface = TriangleMesh::build(mesh);
  REQUIRE(surface);
  int checked = 0;
  for (const Edge& e : surface->edges()) {
    if (angles[e.p] <= 1.0 || angles[e.q] <= 1.0) continue;
    const auto& x = surface->positions();
    const auto normal = [&](Index face) -> Vec3 {
      const Triangle& t = surface->faces()[face];
      return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).normalized();
    };
    const double cosine = normal(e.face0).dot(normal(e.face1));
    const double bend = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
    CHECK(bend == Approx(0.5 * (angles[e.p] + angles[e.q])).margin(5.0));
    ++checked;
  }
  CHECK(checked > 20);
}

TEST_CASE("the head is closed, oriented outward, a ball and without needles") {
  const IndexedMesh mesh = head(30);
  CHECK(mesh.positions.size() == 10 * 30 * 30 + 2);
  const Counts counts = count(mesh);
  CHECK(counts.every_side_has_one_partner);
  CHECK(counts.euler == 2);
  // About that of the ellipsoid it grows from.
  CHECK(volume_of(mesh) == Approx(4.0 / 3.0 * std::numbers::pi * 0.76 * 1.02 * 0.92).epsilon(0.15));
  CHECK(worst_aspect(mesh) < 6.0);
  check_clean_surface(mesh);
}

TEST_CASE("the wavy sheet is open with one boundary of 4 n edges") {
  const Result<TriangleMesh> surface = TriangleMesh::build(wavy_sheet(10));
  REQUIRE(surface);
  CHECK(surface->vertex_count() == 121);
  CHECK(surface->counts().boundary_edges == 40);
}

TEST_CASE("a Delaunay triangulation has no point inside a circumcircle") {
  std::vector<Vec2> points;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      points.emplace_back(i + 0.3 * std::sin(7.0 * i + 3.0 * j), j + 0.3 * std::cos(5.0 * i + j));
    }
  }
  for (const auto& [a, b, c] : delaunay(points)) {
    const Vec2 u = points[b] - points[a];
    const Vec2 v = points[c] - points[a];
    CHECK(u.x() * v.y() - u.y() * v.x() > 0.0);
    for (const Vec2& p : points) {
      Eigen::Matrix3d m;
      for (int k = 0; k < 3; ++k) {
        const Vec2 d = points[k == 0 ? a : k == 1 ? b : c] - p;
        m.row(k) << d.x(), d.y(), d.squaredNorm();
      }
      CHECK(m.determinant() < 1e-9);
    }
  }
}
