#pragma once

#include <span>
#include <vector>

#include "core/edge_geometry.h"
#include "core/mesh.h"
#include "core/surface_geometry.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Relaxes folded edges: at most 10 rounds in which the four vertices of each edge bent by more
/// than 120° (boundary and `held` ones excepted) move half way to the mean of their neighbours.
/// Edges that make a shape stay: a connected line of 12 vertices or more, or more than a tenth of
/// all edges. `held` has one flag per vertex. Returns the number of rounds that moved something;
/// changes `positions`.
int unfold(const TriangleMesh& mesh, std::span<const unsigned char> held,
           std::vector<Vec3>& positions);

/// How rough the mean curvature h is: median |h_p − mean of h over the neighbours| over median |h|,
/// dimensionless, inner vertices only. White noise makes it more than 1, a smooth surface, however
/// curved, close to 0; 0 where nothing is curved.
double curvature_roughness(const TriangleMesh& mesh, std::span<const Vec3> positions,
                           const FaceGeometry& faces, const EdgeCurvature& edges);

/// The most an explicit step may multiply H_A(p) by: ½ / K_pp, dimensionless, with
/// K_pp = ½ Σ over the edges at p of (|cot α| + |cot β|). 0 where no face is present.
std::vector<double> largest_stable_step(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                        const FaceGeometry& faces);

}  // namespace fairway
