#pragma once

#include "core/surface_topology.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// The same answers as surface_topology(), walked over halfedges (OpenMesh), which takes some
/// twenty times as long: to inspect a surface, and to check the quick way.
SurfaceTopology halfedge_topology(const TriangleMesh& mesh);

}  // namespace fairway
