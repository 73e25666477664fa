#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/index.h"

namespace fairway {

using Vec3 = Eigen::Vector3d;
using Triangle = std::array<Index, 3>;

/// A triangle list as a file has it: vertices may coincide, be unused, faces may be degenerate or
/// repeated. Counter-clockwise seen from outside. Every index is < positions.size(): the reader
/// that makes an IndexedMesh guarantees it, and that every position is finite.
struct IndexedMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

}  // namespace fairway
