#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/surface_geometry.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Edge mean curvature of every edge, in the order of TriangleMesh::edges().
/// `vectors` H_e N_e = e × (N0 − N1), eq. (2): length, outward where convex; `values` H_e =
/// ± 2 |e| sin(β/2): length, + convex, − concave; `dihedral_angles` β: radians in [−π, π], 0 =
/// flat. Zero on boundary edges and beside absent faces.
struct EdgeCurvature {
  std::vector<Vec3> vectors;
  std::vector<double> values;
  std::vector<double> dihedral_angles;
};
EdgeCurvature edge_mean_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                  const FaceGeometry& faces);

/// The weight w_{λ,r}(a): 1 for |a| ≤ λ, else λ² / (r (λ − |a|)² + λ²); after (6).
double edge_weight(double edge_mean_curvature, double lambda, double transition);

/// λ = 2 L sin(angle/2), and back; degrees, λ in units of L, clipped to [0°, 180°].
double lambda_of_feature_angle(double degrees, double mean_edge);
double feature_angle_of_lambda(double lambda, double mean_edge);

/// H(p) = ½ Σ_e w_e H_e N_e per vertex, eq. (3) with unit weights, eq. (6) with those of λ:
/// integrated, length, outward where convex. `weights` has one entry per edge, or none for 1.
std::vector<Vec3> mean_curvature_vector(const TriangleMesh& mesh, const EdgeCurvature& edges,
                                        std::span<const double> weights);

/// Median of |β| over interior edges, radians, over 0.6745: the standard deviation of β where noise
/// bends most edges and features few. 0 without interior edges.
double robust_bend(const TriangleMesh& mesh, const EdgeCurvature& edges);

/// σ̂ / L: standard deviation of the noise along the normals in mean edge lengths, robust_bend
/// / 2.309.
double noise_estimate(double robust_bend);

/// Strong edges |H_e| > λ and what they make: weights per edge and feature vertices, eq. (11).
/// Groups of strong edges connected by vertices with fewer than `min_component` vertices are noise:
/// weight 1, no feature.
struct Features {
  std::vector<double> weights;
  std::vector<unsigned char> vertex;
};
Features detect_features(const TriangleMesh& mesh, const EdgeCurvature& edges, double lambda,
                         double transition, int min_component);

}  // namespace fairway
