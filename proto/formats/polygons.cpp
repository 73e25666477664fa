// What the formats of plain meshes have in common: polygons and strips become triangles.

#include "proto/formats/polygons.h"

#include <Eigen/Geometry>
#include <cmath>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr double kMostExtents = 16.0;

Error too_many() {
  return {ErrorCode::too_large,
          fmt::format("The mesh has more than {} triangles; split it first.", kMostTriangles)};
}

}  // namespace

Result<void> add_fan(std::span<const Index> corners, std::vector<Triangle>& triangles) {
  if (corners.size() < 3) {
    return Error{
        ErrorCode::invalid_mesh,
        fmt::format("A face has {} corners; remove faces with fewer than three.", corners.size())};
  }
  if (corners.size() - 2 > kMostTriangles - triangles.size()) return too_many();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    triangles.push_back({corners[0], corners[k], corners[k + 1]});
  }
  return {};
}

Result<void> add_strips(std::span<const std::int64_t> indices, std::size_t vertices,
                        std::vector<Triangle>& triangles) {
  std::vector<Index> strip;
  for (const std::int64_t index : indices) {
    if (index < 0) {
      strip.clear();
      continue;
    }
    const auto vertex = check_index(index, vertices);
    if (!vertex) return vertex.error();
    strip.push_back(*vertex);
    const std::size_t n = strip.size();
    if (n < 3) continue;
    if (triangles.size() == kMostTriangles) return too_many();
    const bool turned = n % 2 == 0;
    triangles.push_back(
        {strip[n - 3], strip[turned ? n - 1 : n - 2], strip[turned ? n - 2 : n - 1]});
  }
  return {};
}

Result<Index> check_index(std::int64_t index, std::size_t vertices) {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
    return Error{ErrorCode::invalid_mesh,
                 fmt::format("A face names vertex {} of {} (counted from 0); correct its indices.",
                             index, vertices)};
  }
  return static_cast<Index>(index);
}

bool fit_floats(std::span<const Vec3> positions) {
  if (positions.empty()) return true;
  Vec3 low = positions.front();
  Vec3 high = low;
  for (const Vec3& position : positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  const double farthest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  return farthest <= kMostExtents * (high - low).norm();
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0.0 && std::isfinite(length) ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

}  // namespace fairway
