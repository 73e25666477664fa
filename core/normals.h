#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// Vertex normals of a mesh that moved, keeping the splits of its old normals.
/// Vertices of one place (equal `place_of_vertex`) whose old normals agree within 0.1° form one
/// smoothing group and share one area-weighted normal of the faces that use them; so hard edges
/// stay hard and texture seams stay smooth. Unit; the old normal where no face has area.
/// `positions` (the new ones), `place_of_vertex` and `old_normals` have one entry per vertex.
std::vector<Vec3> keep_split_normals(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles,
                                     std::span<const Index> place_of_vertex,
                                     std::span<const Vec3> old_normals);

}  // namespace fairway
