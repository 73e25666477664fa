// How positions fit into 32-bit integers.

#include "core/fixed_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fairway {
namespace {

// In mean edges: a unit is 2^-17 L then, and differs from double by 6e-5 L after ten steps at the
// worst that was found.
constexpr double kLargestExtent = 8192.0;
// A face's height, in units: its normal is known to about a tenth of a degree then.
constexpr double kLeastHeight = 512.0;

double largest_coordinate(std::span<const Vec3> positions) {
  double largest = 0.0;
  for (const Vec3& p : positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

}  // namespace

double fixed_point_unit(double largest) {
  return std::exp2(std::ceil(std::log2(std::max(largest, 1.0))) + 1.0 - 31.0);
}

bool fixed_point_serves(const TriangleMesh& mesh, std::span<const Vec3> positions,
                        double mean_edge) {
  const double extent = largest_coordinate(positions) / mean_edge;
  if (!(extent <= kLargestExtent)) return false;
  const double least = kLeastHeight * fixed_point_unit(extent) * mean_edge;
  for (const auto& [a, b, c] : mesh.faces()) {
    const Vec3 u = positions[b] - positions[a];
    const Vec3 v = positions[c] - positions[a];
    const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
    // (2 area)² = (height · longest edge)²
    if (u.cross(v).squaredNorm() < least * least * longest) return false;
  }
  return true;
}

}  // namespace fairway
