// Solids over planar regions with well-shaped triangles: a hexagonal lattice beside the given
// lines, relaxed, triangulated by Delaunay; walls in rows that are staggered by half a side.

#include "tests/figures/plate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace fairway {
namespace {

constexpr double kRowHeight = std::numbers::sqrt3 / 2.0;
// Lattice points nearer than this to a given point, in spacings, are left out: then edges between
// neighbouring given points are Delaunay.
constexpr double kClearance = 0.75;
constexpr int kRelaxations = 4;
constexpr double kCornerTurn = 0.5;  // radians

bool inside(const PlanarRegion& region, const Vec2& p) {
  bool in = false;
  for (const std::vector<Vec2>& loop : region.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2& a = loop[i];
      const Vec2& b = loop[(i + 1) % loop.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) in = !in;
    }
  }
  return in;
}

/// The lattice over the region and a border around it, clear of the points in `given`.
std::vector<Vec2> lattice(const std::vector<Vec2>& given, double spacing) {
  Vec2 low = given.front();
  Vec2 high = low;
  for (const Vec2& p : given) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low.array() -= 3.0 * spacing;
  high.array() += 3.0 * spacing;
  std::vector<Vec2> out;
  int row = 0;
  for (double y = low.y(); y < high.y(); y += kRowHeight * spacing, ++row) {
    for (double x = low.x() + 0.5 * spacing * (row % 2); x < high.x(); x += spacing) {
      const Vec2 p(x, y);
      const bool clear = std::ranges::all_of(
          given, [&](const Vec2& q) { return (p - q).norm() >= kClearance * spacing; });
      if (clear) out.push_back(p);
    }
  }
  return out;
}

/// Moves the points that may move to the mean of their neighbours.
void relax(std::vector<Vec2>& points, const std::vector<bool>& may_move) {
  std::vector<Vec2> sum(points.size(), Vec2::Zero());
  std::vector<int> valence(points.size(), 0);
  for (const Triangle& t : delaunay(points)) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Each neighbour comes once: from the triangle on the left of the side towards it.
      sum[t[k]] += points[t[(k + 1) % 3]];
      ++valence[t[k]];
    }
  }
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (may_move[v]) points[v] = sum[v] / valence[v];
  }
}

/// Drops the points that no triangle uses, except the first `kept`.
PlanarMesh compact(const std::vector<Vec2>& points, std::vector<Triangle> triangles,
                   std::size_t kept) {
  std::vector<Index> renamed(points.size(), kNoIndex);
  std::iota(renamed.begin(), renamed.begin() + static_cast<std::ptrdiff_t>(kept), Index{0});
  PlanarMesh out{{points.begin(), points.begin() + static_cast<std::ptrdiff_t>(kept)}, {}};
  for (Triangle& t : triangles) {
    for (Index& v : t) {
      if (renamed[v] == kNoIndex) {
        renamed[v] = static_cast<Index>(out.points.size());
        out.points.push_back(points[v]);
      }
      v = renamed[v];
    }
  }
  out.triangles = std::move(triangles);
  return out;
}

/// One row of a wall: vertices and where they stand along the loop, in points of the loop.
struct WallRow {
  std::vector<Index> vertices;
  std::vector<double> places;
};

/// Triangles between two rows; `upper` above `lower` for someone outside who sees the loop run to
/// the right.
void zip(const WallRow& upper, const WallRow& lower, double around,
         std::vector<Triangle>& triangles) {
  const auto place = [around](const WallRow& row, std::size_t i) {
    const std::size_t n = row.places.size();
    return row.places[i % n] + (i >= n ? around : 0.0);
  };
  const auto vertex = [](const WallRow& row, std::size_t i) {
    return row.vertices[i % row.vertices.size()];
  };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < upper.vertices.size() || j < lower.vertices.size()) {
    const bool along_lower =
        i == upper.vertices.size() ||
        (j < lower.vertices.size() &&
         place(lower, j) + place(lower, j + 1) < place(upper, i) + place(upper, i + 1));
    if (along_lower) {
      triangles.push_back({vertex(lower, j), vertex(lower, j + 1), vertex(upper, i)});
      ++j;
    } else {
      triangles.push_back({vertex(lower, j), vertex(upper, i + 1), vertex(upper, i)});
      ++i;
    }
  }
}

bool is_corner(const std::vector<Vec2>& loop, std::size_t i) {
  const Vec2 in = loop[i] - loop[(i + loop.size() - 1) % loop.size()];
  const Vec2 out = loop[(i + 1) % loop.size()] - loop[i];
  return std::abs(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out))) > kCornerTurn;
}

/// A wall under the loop whose top vertices start at `first`; the bottom ones `below` further.
class Wall {
 public:
  Wall(const std::vector<Vec2>& loop, Index first, Index below)
      : loop_(loop), first_(first), below_(below) {}

  void add_to(IndexedMesh& mesh, double spacing) const {
    double height = 0.0;
    for (Index i = 0; i < loop_.size(); ++i) {
      height += mesh.positions[first_ + i].z() - mesh.positions[first_ + below_ + i].z();
    }
    height /= static_cast<double>(loop_.size());
    const int rows =
        2 * std::max(1, static_cast<int>(std::lround(height / spacing * 0.5 / kRowHeight)));
    WallRow above = whole_row(first_);
    for (int r = 1; r <= rows; ++r) {
      WallRow row = r == rows ? whole_row(first_ + below_)
                              : inner_row(mesh, static_cast<double>(r) / rows, r % 2 == 1);
      zip(above, row, static_cast<double>(loop_.size()), mesh.triangles);
      above = std::move(row);
    }
  }

 private:
  WallRow whole_row(Index first) const {
    WallRow row{std::vector<Index>(loop_.size()), std::vector<double>(loop_.size())};
    std::iota(row.vertices.begin(), row.vertices.end(), first);
    std::iota(row.places.begin(), row.places.end(), 0.0);
    return row;
  }

  WallRow inner_row(IndexedMesh& mesh, double down, bool staggered) const {
    WallRow row;
    const auto add = [&](double place, const Vec3& p) {
      row.vertices.push_back(static_cast<Index>(mesh.positions.size()));
      row.places.push_back(place);
      mesh.positions.push_back(p);
    };
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const auto place = static_cast<double>(i);
      if (!staggered || is_corner(loop_, i)) add(place, at(mesh, i, down));
      if (staggered) add(place + 0.5, half_way(mesh, i, down));
    }
    return row;
  }

  /// Below point i of the loop (counted around), 0 = top, 1 = bottom.
  Vec3 at(const IndexedMesh& mesh, std::size_t i, double down) const {
    const auto v = first_ + static_cast<Index>(i % loop_.size());
    return (1.0 - down) * mesh.positions[v] + down * mesh.positions[v + below_];
  }

  /// Between point i and the next: on the curve that their neighbours suggest (the four-point rule
  /// of Dyn, Levin, Gregory 1987), beside a corner on the chord.
  Vec3 half_way(const IndexedMesh& mesh, std::size_t i, double down) const {
    const std::size_t n = loop_.size();
    Vec3 chord = 0.5 * (at(mesh, i, down) + at(mesh, i + 1, down));
    if (is_corner(loop_, i) || is_corner(loop_, (i + 1) % n)) return chord;
    return 1.125 * chord - 0.0625 * (at(mesh, i + n - 1, down) + at(mesh, i + 2, down));
  }

  const std::vector<Vec2>& loop_;
  Index first_;
  Index below_;
};

}  // namespace

PlanarMesh triangulate(const PlanarRegion& region) {
  std::vector<Vec2> points;
  for (const auto& loop : region.loops) points.insert(points.end(), loop.begin(), loop.end());
  for (const auto& line : region.creases) points.insert(points.end(), line.begin(), line.end());
  const std::size_t given = points.size();
  const std::vector<Vec2> more = lattice(points, region.spacing);
  points.insert(points.end(), more.begin(), more.end());
  std::vector<bool> may_move(points.size());
  for (std::size_t v = given; v < points.size(); ++v) may_move[v] = inside(region, points[v]);
  for (int k = 0; k < kRelaxations; ++k) relax(points, may_move);
  std::vector<Triangle> triangles = delaunay(points);
  std::erase_if(triangles, [&](const Triangle& t) {
    return !inside(region, (points[t[0]] + points[t[1]] + points[t[2]]) / 3.0);
  });
  return compact(points, std::move(triangles), given);
}

IndexedMesh extrude(const PlanarRegion& region, const std::function<double(const Vec2&)>& top,
                    double bottom) {
  const PlanarMesh flat = triangulate(region);
  const auto below = static_cast<Index>(flat.points.size());
  IndexedMesh mesh;
  for (const Vec2& p : flat.points) mesh.positions.emplace_back(p.x(), p.y(), top(p));
  for (const Vec2& p : flat.points) mesh.positions.emplace_back(p.x(), p.y(), bottom);
  for (const auto& [a, b, c] : flat.triangles) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + below, c + below, b + below});
  }
  Index first = 0;
  for (const auto& loop : region.loops) {
    Wall(loop, first, below).add_to(mesh, region.spacing);
    first += static_cast<Index>(loop.size());
  }
  return mesh;
}

std::vector<Vec2> segment(const Vec2& a, const Vec2& b, double spacing) {
  const int steps = 2 * std::max(1, static_cast<int>(std::lround((b - a).norm() / spacing / 2.0)));
  std::vector<Vec2> out;
  for (int i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    out.emplace_back((1.0 - t) * a + t * b);
  }
  return out;
}

std::vector<Vec2> arc(double radius, double from, double to, double spacing) {
  const double length = radius * std::abs(to - from);
  const int steps = 2 * std::max(2, static_cast<int>(std::lround(length / spacing / 2.0)));
  std::vector<Vec2> out;
  for (int i = 0; i < steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    out.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return out;
}

}  // namespace fairway
