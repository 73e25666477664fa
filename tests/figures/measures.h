#pragma once

#include <vector>

#include "core/denoise.h"
#include "core/mesh.h"
#include "core/result.h"

namespace fairway {

/// The mesh after a flow, vertex for vertex. Errors: those of TriangleMesh::build and denoise.
Result<IndexedMesh> after_flow(const IndexedMesh& mesh, const FlowOptions& options);

/// |predominant principal curvature| times the mean edge length, per vertex: dimensionless, about
/// 1.6 on a right-angled edge and 0 where flat. Errors: those of TriangleMesh::build.
Result<std::vector<double>> relative_curvature(const IndexedMesh& mesh);

/// Signed volume of a closed mesh, length³, and area, length².
double volume_of(const IndexedMesh& mesh);
double area_of(const IndexedMesh& mesh);

/// Mean over the edges of the triangles (inner ones count twice), length.
double mean_edge_of(const IndexedMesh& mesh);

/// Distance of each vertex to the surface of `original`, length, by looking at every triangle of
/// it: meant for an original of few.
std::vector<double> distances(const IndexedMesh& mesh, const IndexedMesh& original);

/// The plain mean curvature flow as commonly written: p ← p − c ½ Σ (cot α + cot β) (p − q), c =
/// min(3 s / area(star p), ½ / K_pp) as in core, s = `step_size` L², one cotangent on boundary
/// edges. The other side of Fig. 4: it pulls boundaries inward.
IndexedMesh cotangent_flow(IndexedMesh mesh, double step_size, int steps);

}  // namespace fairway
