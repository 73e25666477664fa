#pragma once

#include <span>
#include <vector>

#include "core/denoise.h"

namespace fairway {

/// 1 per surface vertex that does not move: fixed ones and, where the options say so, the boundary.
std::vector<unsigned char> held_vertices(const TriangleMesh& mesh, const FlowOptions& options);

/// Fills in what a run did to the surface as a whole: volumes, areas, displacements, flipped faces.
/// `positions`: where it ended; `mean_edge`: the length that displacements are told in.
void compare_surfaces(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
                      FlowReport& report);

}  // namespace fairway
