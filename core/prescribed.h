#pragma once

#include <span>
#include <vector>

#include "core/edge_geometry.h"
#include "core/flow_options.h"
#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// The right-hand side f̃ V_A of the prescribed mean curvature flows, eq. (10), (11), in its parts.
/// Kinds of vertices: feature vertices and the others; without features there is one kind.
struct PrescribedCurvature {
  std::vector<Vec3> direction;  ///< V_A: ∇vol (length²) off features, a unit vector on them
  std::vector<double> value;    ///< f̃, signed, averaged: 1/length off features, length on them

  Vec3 vector(std::size_t v) const { return value[v] * direction[v]; }
};

/// H_A^s(p) = ½ (H_A(p) + the angle-weighted mean of H_A over the neighbours), length: over feature
/// neighbours (`recommended`) or all (`paper`); H_A(p) where none counts.
Vec3 smoothed_mean_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                             const FaceGeometry& faces, std::span<const Vec3> mean_curvature,
                             std::span<const unsigned char> feature, Conventions conventions,
                             Index vertex);

/// f̃ and V_A of a surface with anisotropic mean curvature vectors `mean_curvature` (H_A, or H for
/// the isotropic flow) and `feature` flags (all zero for the isotropic flow). `conventions` chooses
/// which neighbours H_A^s and f̃ average over.
PrescribedCurvature prescribed_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                         const FaceGeometry& faces,
                                         std::span<const Vec3> mean_curvature,
                                         std::span<const unsigned char> feature, double mean_edge,
                                         const CurvatureSmoothing& smoothing,
                                         Conventions conventions);

}  // namespace fairway
