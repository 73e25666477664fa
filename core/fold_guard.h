#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Moves vertices of faces that came out folded over (turned by 80° or more against the normals
/// around) or as slivers (an angle below 1° and below half of what it was) within the surface
/// towards the mean of their neighbours, as long as there are fewer such faces for it and no other
/// face turns by 15°. Boundary and `held` vertices stay. `positions`: one per surface vertex.
/// Returns the number of vertices moved. Deterministic.
std::size_t mend_folds(const TriangleMesh& mesh, std::span<const unsigned char> held,
                       std::vector<Vec3>& positions);

}  // namespace fairway
