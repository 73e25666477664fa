// The flows written down once more, plainly: edge by edge in double, whole vectors at a time.

#include "tests/core/reference_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/edge_geometry.h"
#include "core/guards.h"
#include "core/prescribed.h"
#include "core/surface_geometry.h"

namespace fairway::test {
namespace {

/// H_A − f̃ V_A per vertex (H_A alone for the mean curvature flows).
std::vector<Vec3> velocity(const TriangleMesh& mesh, std::span<const Vec3> x,
                           const FlowOptions& options, double mean_edge,
                           const FaceGeometry& faces) {
  const EdgeCurvature edges = edge_mean_curvature(mesh, x, faces);
  Features features{{}, std::vector<unsigned char>(mesh.vertex_count())};
  if (is_anisotropic(options.method)) {
    const double lambda = options.lambda
                              ? *options.lambda
                              : lambda_of_feature_angle(*options.feature_angle, mean_edge);
    features =
        detect_features(mesh, edges, lambda, options.transition, options.guards.min_component);
  }
  std::vector<Vec3> out = mean_curvature_vector(mesh, edges, features.weights);
  if (!is_prescribed(options.method)) return out;
  const PrescribedCurvature prescribed =
      prescribed_curvature(mesh, x, faces, out, features.vertex, mean_edge,
                           options.curvature_smoothing, options.conventions);
  for (std::size_t v = 0; v < out.size(); ++v) out[v] -= prescribed.vector(v);
  return out;
}

}  // namespace

std::vector<Vec3> reference_flow(const TriangleMesh& mesh, const FlowOptions& options) {
  std::vector<Vec3> x = mesh.positions();
  const double mean_edge = mean_edge_length(mesh, x);
  const double s = *options.step_size * mean_edge * mean_edge;
  for (int step = 0; step < *options.steps; ++step) {
    const FaceGeometry faces = face_geometry(mesh, x, smallest_area(mean_edge));
    const std::vector<Vec3> v = velocity(mesh, x, options, mean_edge, faces);
    const std::vector<double> mass = lumped_mass(mesh, faces);
    const std::vector<double> stable = largest_stable_step(mesh, x, faces);
    for (std::size_t p = 0; p < x.size(); ++p) {
      if (options.boundary == Boundary::fixed && mesh.boundary_vertex()[p] != 0) continue;
      const double plain = mass[p] > 0.0 ? s / mass[p] : 0.0;
      x[p] -= (options.guards.local_step ? std::min(plain, stable[p]) : plain) * v[p];
    }
  }
  return x;
}

}  // namespace fairway::test
