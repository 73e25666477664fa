#pragma once

#include <span>
#include <vector>

#include "core/edge_geometry.h"
#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Eigen-decomposition of the vertex shape operator
/// S(p) = ½ Σ_e ω_e H_e t_e t_eᵗ, eq. (5), on the plane orthogonal to the vertex normal;
/// ω_e = ⟨N_p, N_e⟩, t_e = unit projection of e × N_e. Integrated, length, convex positive,
/// `major` ≥ `minor`; unit directions, sign free. Zero where there is no normal.
struct ShapeOperator {
  std::vector<double> major, minor;
  std::vector<Vec3> major_direction, minor_direction;
};
ShapeOperator shape_operator(const TriangleMesh& mesh, std::span<const Vec3> positions,
                             const EdgeCurvature& edges, std::span<const Vec3> normals);

}  // namespace fairway
