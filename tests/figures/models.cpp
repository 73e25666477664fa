// Models with straight, curved and vanishing creases, and an open one.

#include "tests/figures/models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/shapes.h"
#include "tests/figures/plate.h"

namespace fairway {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInnerRadius = 0.5;
constexpr double kRidgeRadius = 1.0;
constexpr double kOuterRadius = 1.5;
constexpr double kFan = 130.0 * kPi / 180.0;
constexpr double kRidgeStart = 60.0;  // degrees
constexpr double kRidgeHeight = 0.3;

void append(std::vector<Vec2>& to, const std::vector<Vec2>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Crease angle of the ridge in degrees in the direction of p from the axis.
double crease_angle(const Vec2& p) {
  // Full over the first tenth, gone at nine tenths.
  const double along = std::atan2(p.y(), p.x()) / kFan;
  const double t = std::clamp((along - 0.1) / 0.8, 0.0, 1.0);
  return kRidgeStart * (1.0 - t * t * (3.0 - 2.0 * t));
}

Vec2 at_angle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

IndexedMesh drilled_block(double spacing) {
  PlanarRegion region{{{}, arc(0.6, 2.0 * kPi, 0.0, spacing)}, {}, spacing};
  const Vec2 corners[] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  for (int k = 0; k < 4; ++k) {
    append(region.loops[0], segment(corners[k], corners[(k + 1) % 4], spacing));
  }
  return extrude(
      region, [](const Vec2&) { return 0.4; }, -0.4);
}

double vanishing_ridge_angle_at(const Vec3& p) {
  const Vec2 flat = p.head<2>();
  const bool on_ridge = p.z() == kRidgeHeight && std::abs(flat.norm() - kRidgeRadius) < 1e-9;
  return on_ridge ? crease_angle(flat) : 0.0;
}

IndexedMesh vanishing_ridge(double spacing) {
  PlanarRegion region{{{}}, {}, spacing};
  std::vector<Vec2>& outline = region.loops[0];
  outline = segment(at_angle(kInnerRadius, 0.0), at_angle(kOuterRadius, 0.0), spacing);
  append(outline, arc(kOuterRadius, 0.0, kFan, spacing));
  append(outline, segment(at_angle(kOuterRadius, kFan), at_angle(kInnerRadius, kFan), spacing));
  append(outline, arc(kInnerRadius, kFan, 0.0, spacing));
  // Its first point is one of the outline's already.
  std::vector<Vec2> ridge = arc(kRidgeRadius, 0.0, kFan, spacing);
  ridge.erase(ridge.begin());
  region.creases.push_back(std::move(ridge));
  const auto top = [](const Vec2& p) {
    const double slope = std::tan(0.5 * crease_angle(p) * kPi / 180.0);
    const double off = std::abs(p.norm() - kRidgeRadius);
    return kRidgeHeight - (off < 1e-9 ? 0.0 : slope * off);
  };
  return extrude(region, top, -0.4);
}

IndexedMesh wavy_sheet(int n) {
  IndexedMesh mesh = sheet(static_cast<Index>(n));
  for (Vec3& p : mesh.positions) {
    p.z() = 0.16 * std::sin(kPi * p.x()) * std::cos(kPi * p.y());
  }
  return mesh;
}

}  // namespace fairway
