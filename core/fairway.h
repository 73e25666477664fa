#pragma once

/// Everything that core offers to other programs. Installed as <fairway/fairway.h>, beside
/// <fairway/core/...> for those who want less. In three calls a mesh is denoised:
/// TriangleMesh::build(), denoise(), TriangleMesh::scatter_positions(); curvature() tells how the
/// result is curved.

#include "core/curvature.h"         // IWYU pragma: export
#include "core/denoise.h"           // IWYU pragma: export
#include "core/features.h"          // IWYU pragma: export
#include "core/halfedge.h"          // IWYU pragma: export
#include "core/normals.h"           // IWYU pragma: export
#include "core/shapes.h"            // IWYU pragma: export
#include "core/surface_geometry.h"  // IWYU pragma: export
#include "core/surface_measures.h"  // IWYU pragma: export
#include "core/surface_topology.h"  // IWYU pragma: export
