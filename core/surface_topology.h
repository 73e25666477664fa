#pragma once

#include <cstddef>

#include "core/triangle_mesh.h"

namespace fairway {

/// Global topology of a surface.
struct SurfaceTopology {
  std::size_t components = 0;
  std::size_t boundary_loops = 0;
  long euler_characteristic = 0;  ///< V − E + F
};

/// Follows the rings: linear time, no halfedges.
SurfaceTopology surface_topology(const TriangleMesh& mesh);

}  // namespace fairway
