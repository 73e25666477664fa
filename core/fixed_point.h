#pragma once

#include <span>

#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// One unit of a fixed-point coordinate, in mean edges L: 31 bits for coordinates up to `largest`
/// L, with room for as much again.
double fixed_point_unit(double largest);

/// Whether fixed-point positions serve a surface of mean edge `mean_edge`: its extent and its
/// thinnest faces are such that rounding moves nothing by 1e-4 L in ten steps. A face without area
/// must stay one: rounding would give it a normal.
bool fixed_point_serves(const TriangleMesh& mesh, std::span<const Vec3> positions,
                        double mean_edge);

}  // namespace fairway
