#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway {

using Vec2 = Eigen::Vector2d;

/// Delaunay triangulation of points in the plane, counter-clockwise. Quadratic time: for a few
/// thousand points. The points must be distinct and not all collinear; what is triangulated is
/// exact only away from the convex hull (give a border of points that are not needed).
std::vector<Triangle> delaunay(std::span<const Vec2> points);

}  // namespace fairway
