// Sizes of edges and faces, in one walk over each.

#include "core/surface_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace fairway {
namespace {

/// Height over longest side below which a triangle is a needle.
constexpr double kNeedle = 0.01;

class SpreadSum {
 public:
  void add(double value) {
    least_ = std::min(least_, value);
    largest_ = std::max(largest_, value);
    sum_ += value;
    ++count_;
  }
  double sum() const { return sum_; }
  Spread spread() const {
    if (count_ == 0) return {};
    return {least_, sum_ / static_cast<double>(count_), largest_};
  }

 private:
  double least_ = std::numeric_limits<double>::infinity();
  double largest_ = 0.0;
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace

SurfaceMeasures surface_measures(const TriangleMesh& mesh) {
  const std::vector<Vec3>& x = mesh.positions();
  SurfaceMeasures out;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : x) box.extend(p);
  out.box_min = box.min() + mesh.origin();
  out.box_max = box.max() + mesh.origin();
  SpreadSum lengths;
  for (const Edge& edge : mesh.edges()) lengths.add((x[edge.p] - x[edge.q]).norm());
  SpreadSum areas;
  for (const auto& [a, b, c] : mesh.faces()) {
    const Vec3 ab = x[b] - x[a];
    const Vec3 ac = x[c] - x[a];
    const double twice_area = ab.cross(ac).norm();
    const double longest =
        std::max({ab.squaredNorm(), ac.squaredNorm(), (x[c] - x[b]).squaredNorm()});
    areas.add(twice_area / 2.0);
    if (twice_area < kNeedle * longest) ++out.needles;
  }
  out.edges = mesh.edges().size();
  out.edge_length = lengths.spread();
  out.triangle_area = areas.spread();
  out.area = areas.sum();
  return out;
}

}  // namespace fairway
