#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/weld.h"

namespace fairway {

/// True of a large mesh whose list of faces runs all over its vertices: to walk such a list costs a
/// cache miss per corner. Looks at a sample of the faces.
bool in_no_order(std::span<const Triangle> faces, std::size_t vertex_count);

/// Renumbers the classes of `weld` along a Morton curve, in `faces` too, and sorts the faces by
/// their least corners, those of the same one in the order they had. `positions`: those that were
/// welded.
void order_in_space(std::span<const Vec3> positions, Weld& weld, std::vector<Triangle>& faces);

}  // namespace fairway
