// Incremental Delaunay triangulation.
// Sources: Bowyer 1981, Watson 1981.

#include "tests/figures/delaunay.h"

#include <algorithm>
#include <array>
#include <utility>

namespace fairway {
namespace {

struct Circled {
  Triangle corners;
  Vec2 centre;
  double squared_radius;
};

Circled circled(std::span<const Vec2> points, Triangle corners) {
  const Vec2& a = points[corners[0]];
  const Vec2 b = points[corners[1]] - a;
  const Vec2 c = points[corners[2]] - a;
  const double twice = 2.0 * (b.x() * c.y() - b.y() * c.x());
  const Vec2 centre((c.y() * b.squaredNorm() - b.y() * c.squaredNorm()) / twice,
                    (b.x() * c.squaredNorm() - c.x() * b.squaredNorm()) / twice);
  return {corners, a + centre, centre.squaredNorm()};
}

/// Sides of `removed` that no other of them has: the rim of the cavity, counter-clockwise.
std::vector<std::pair<Index, Index>> rim(const std::vector<Triangle>& removed) {
  std::vector<std::pair<Index, Index>> sides;
  for (const Triangle& t : removed) {
    for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::vector<std::pair<Index, Index>> out;
  for (const auto& [a, b] : sides) {
    if (std::find(sides.begin(), sides.end(), std::pair{b, a}) == sides.end()) {
      out.emplace_back(a, b);
    }
  }
  return out;
}

}  // namespace

std::vector<Triangle> delaunay(std::span<const Vec2> points) {
  const auto count = static_cast<Index>(points.size());
  std::vector<Vec2> all(points.begin(), points.end());
  Vec2 low = points.front();
  Vec2 high = low;
  for (const Vec2& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec2 middle = 0.5 * (low + high);
  const double far = 1e3 * (high - low).norm();
  for (const Vec2& corner : {Vec2(-far, -far), Vec2(far, -far), Vec2(0.0, far)}) {
    all.emplace_back(middle + corner);
  }
  std::vector<Circled> triangles = {circled(all, {count, count + 1, count + 2})};
  std::vector<Triangle> removed;
  for (Index v = 0; v < count; ++v) {
    removed.clear();
    std::erase_if(triangles, [&](const Circled& t) {
      // Points on the circle count as outside, so that rounding opens no second cavity.
      if ((all[v] - t.centre).squaredNorm() >= t.squared_radius * (1.0 - 1e-10)) return false;
      removed.push_back(t.corners);
      return true;
    });
    for (const auto& [a, b] : rim(removed)) triangles.push_back(circled(all, {a, b, v}));
  }
  std::vector<Triangle> out;
  for (const Circled& t : triangles) {
    if (std::ranges::all_of(t.corners, [&](Index v) { return v < count; })) {
      out.push_back(t.corners);
    }
  }
  return out;
}

}  // namespace fairway
