#pragma once

#include <span>
#include <vector>

#include "core/execution.h"
#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Pointwise curvature per vertex, in 1/length (gaussian 1/length²), convex positive, k1 ≥ k2.
/// `mean` = (k1 + k2)/2, `gaussian` = angle defect / mixed area (0 at boundary vertices),
/// `predominant` = the k of larger magnitude, signed; `dir1`, `dir2` unit eigenvectors of k1, k2 in
/// the tangent plane, sign free. Zero where a vertex has no usable face.
struct CurvatureFields {
  std::vector<double> k1, k2, mean, gaussian, predominant;
  std::vector<Vec3> dir1, dir2;
};

/// Curvature of a surface at `positions` (one per surface vertex, relative to its origin):
/// eigenvalues of the shape operator S(p), eq. (5), over the mixed Voronoi area. In double
/// precision, on `execution.threads` threads.
CurvatureFields curvature(const TriangleMesh& surface, std::span<const Vec3> positions,
                          const Execution& execution = {});

/// CurvatureFields rounded to single precision, in the same units and signs; numbers beyond its
/// range become its ends. `dir1` and `dir2` have three numbers per vertex.
struct CurvatureFloats {
  std::vector<float> k1, k2, mean, gaussian, predominant, dir1, dir2;
};

/// The same computation as curvature(), its results rounded: half the memory.
CurvatureFloats curvature_floats(const TriangleMesh& surface, std::span<const Vec3> positions,
                                 const Execution& execution = {});

/// Fields per source vertex (welded copies share values, isolated vertices get zeros).
CurvatureFields scatter(const TriangleMesh& surface, const CurvatureFields& fields);

}  // namespace fairway
