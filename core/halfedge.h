#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/surface_topology.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// A closed line of boundary edges.
struct BoundaryLoop {
  std::size_t edges = 0;
  double length = 0.0;
};

/// One connected piece of a surface.
struct ComponentTopology {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t boundary_loops = 0;
  long euler_characteristic = 0;  ///< V − E + F

  /// Number of handles, (2 − χ)/2, of a closed piece; nothing of an open one.
  std::optional<long> genus() const {
    if (boundary_loops > 0) return std::nullopt;
    return (2 - euler_characteristic) / 2;
  }
};

/// What halfedges tell beyond the counts.
struct HalfedgeTopology : SurfaceTopology {
  std::vector<BoundaryLoop> loops;        ///< longest first
  std::vector<ComponentTopology> pieces;  ///< most faces first
};

/// The same answers as surface_topology(), walked over halfedges (OpenMesh), which takes some
/// twenty times as long, and each loop and component by itself: to inspect a surface, and to check
/// the quick way.
HalfedgeTopology halfedge_topology(const TriangleMesh& mesh);

}  // namespace fairway
