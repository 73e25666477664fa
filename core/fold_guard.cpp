// Folded faces and slivers that denoising leaves where triangles were thin already.

#include "core/fold_guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fairway {
namespace {

constexpr int kRounds = 8;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kThinAngle = 1.0 * kDegree;
constexpr double kShareOfBefore = 0.5;
constexpr std::array<double, 3> kWays = {0.25, 0.5, 1.0};
const double kFolded = std::cos(80.0 * kDegree);
const double kMostTurned = std::cos(15.0 * kDegree);

Vec3 scaled_normal(std::span<const Vec3> x, const Triangle& f) {
  return (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
}

double least_angle(std::span<const Vec3> x, const Triangle& f) {
  const double height = scaled_normal(x, f).norm();
  double least = std::numbers::pi;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = x[f[(k + 1) % 3]] - x[f[k]];
    const Vec3 b = x[f[(k + 2) % 3]] - x[f[k]];
    least = std::min(least, std::atan2(height, a.dot(b)));
  }
  return least;
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

class Guard {
 public:
  Guard(const TriangleMesh& mesh, std::span<const unsigned char> held, std::vector<Vec3>& x)
      : mesh_(mesh), held_(held), x_(x) {
    find_normals();
  }

  std::size_t run() {
    std::size_t moved = 0;
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t now = mend_round();
      moved += now;
      if (now == 0) break;
    }
    return moved;
  }

 private:
  void find_normals();
  bool bad(Index face) const;
  std::size_t bad_around(Index v) const;
  std::size_t mend_round();
  bool mend(Index v);
  bool turns_others(Index v, std::span<const Vec3> before) const;

  const TriangleMesh& mesh_;
  const std::span<const unsigned char> held_;
  std::vector<Vec3>& x_;
  std::vector<Vec3> normals_;  // per vertex, averaged once over the ring
};

void Guard::find_normals() {
  std::vector<Vec3> once(x_.size(), Vec3::Zero());
  for (const Triangle& f : mesh_.faces()) {
    const Vec3 normal = scaled_normal(x_, f);
    for (const Index v : f) once[v] += normal;
  }
  for (Vec3& normal : once) normal = unit_or_zero(normal);
  normals_ = once;
  for (std::size_t v = 0; v < normals_.size(); ++v) {
    for (const Index w : mesh_.rings()[v]) normals_[v] += once[w];
    normals_[v] = unit_or_zero(normals_[v]);
  }
}

bool Guard::bad(Index face) const {
  const Triangle& f = mesh_.faces()[face];
  const Vec3 normal = scaled_normal(x_, f);
  const Vec3 around = normals_[f[0]] + normals_[f[1]] + normals_[f[2]];
  if (normal.dot(around) < kFolded * normal.norm() * around.norm()) return true;
  const double angle = least_angle(x_, f);
  return angle < kThinAngle && angle < kShareOfBefore * least_angle(mesh_.positions(), f);
}

std::size_t Guard::bad_around(Index v) const {
  const std::span<const Index> star = mesh_.vertex_faces()[v];
  return static_cast<std::size_t>(
      std::count_if(star.begin(), star.end(), [this](Index f) { return bad(f); }));
}

/// Whether a face that was good before the vertex moved has turned too far. `before`: the unit
/// normals of its faces, zero for bad ones.
bool Guard::turns_others(Index v, std::span<const Vec3> before) const {
  const std::span<const Index> star = mesh_.vertex_faces()[v];
  for (std::size_t k = 0; k < star.size(); ++k) {
    if (before[k].isZero(0.0)) continue;
    const Vec3 normal = scaled_normal(x_, mesh_.faces()[star[k]]);
    if (before[k].dot(normal) < kMostTurned * normal.norm()) return true;
  }
  return false;
}

bool Guard::mend(Index v) {
  const std::size_t before = bad_around(v);
  if (before == 0) return false;
  Vec3 way = Vec3::Zero();
  for (const Index w : mesh_.rings()[v]) way += x_[w];
  way = way / static_cast<double>(mesh_.rings()[v].size()) - x_[v];
  way -= way.dot(normals_[v]) * normals_[v];
  std::vector<Vec3> normals;
  for (const Index f : mesh_.vertex_faces()[v]) {
    normals.push_back(bad(f) ? Vec3(Vec3::Zero())
                             : unit_or_zero(scaled_normal(x_, mesh_.faces()[f])));
  }
  const Vec3 from = x_[v];
  Vec3 best = from;
  std::size_t least = before;
  for (const double far : kWays) {
    x_[v] = from + far * way;
    const std::size_t count = bad_around(v);
    if (count >= least || turns_others(v, normals)) continue;
    least = count;
    best = x_[v];
  }
  x_[v] = best;
  return least < before;
}

std::size_t Guard::mend_round() {
  std::vector<Index> concerned;
  for (Index f = 0; f < mesh_.faces().size(); ++f) {
    if (!bad(f)) continue;
    concerned.insert(concerned.end(), mesh_.faces()[f].begin(), mesh_.faces()[f].end());
  }
  std::sort(concerned.begin(), concerned.end());
  concerned.erase(std::unique(concerned.begin(), concerned.end()), concerned.end());
  std::size_t moved = 0;
  for (const Index v : concerned) {
    if (held_[v] != 0 || mesh_.boundary_vertex()[v] != 0) continue;
    if (mend(v)) ++moved;
  }
  return moved;
}

}  // namespace

std::size_t mend_folds(const TriangleMesh& mesh, std::span<const unsigned char> held,
                       std::vector<Vec3>& positions) {
  return Guard(mesh, held, positions).run();
}

}  // namespace fairway
