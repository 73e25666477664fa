#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// The positions' indices along a Morton curve through a grid of 1024³ cells over their bounding
/// box, ascending within a cell: neighbours in space are neighbours in the order. Linear time.
/// Positions must be finite.
std::vector<Index> morton_order(std::span<const Vec3> positions);

}  // namespace fairway
