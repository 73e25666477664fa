// Prescribed mean curvature: direction V_A and averaged value f̃ per vertex.
// Source: Hildebrandt & Polthier 2004, eqs. (9)–(11) and the text before (11).

#include "core/prescribed.h"

#include <Eigen/Geometry>

namespace fairway {
namespace {

// |H_A^s| below this many mean edge lengths has no direction.
constexpr double kNoDirection = 1e-14;

/// ω of an edge at its end v: the sum of the angles at v in the triangles beside the edge.
double angle_weight(const Edge& e, Index v, std::span<const Vec3> x, const FaceGeometry& faces) {
  double sum = 0.0;
  const Index w = other_end(e, v);
  if (e.face0 != kNoIndex && faces.present(e.face0)) sum += angle_at(x[v], x[w], x[e.opposite0]);
  if (e.face1 != kNoIndex && faces.present(e.face1)) sum += angle_at(x[v], x[w], x[e.opposite1]);
  return sum;
}

/// f of one vertex before averaging: sign⟨H, V⟩ |H| / |V|, 0 where V = 0.
double curvature_value(const Vec3& mean_curvature, const Vec3& direction) {
  const double length = direction.norm();
  if (length == 0.0) return 0.0;
  const double value = mean_curvature.norm() / length;
  return mean_curvature.dot(direction) < 0.0 ? -value : value;
}

/// One pass f ← (1 − m) f + m · average over the neighbours that count; f where none does.
std::vector<double> average(const TriangleMesh& mesh, const std::vector<double>& f,
                            std::span<const unsigned char> feature, double fraction,
                            Conventions conventions) {
  std::vector<double> out(f);
  for (Index v = 0; v < f.size(); ++v) {
    double sum = 0.0;
    double count = 0.0;
    for (const Index i : mesh.vertex_edges()[v]) {
      const Index q = other_end(mesh.edges()[i], v);
      const bool same_kind = feature[q] == feature[v];
      if (!same_kind && (conventions == Conventions::recommended || feature[v] != 0)) continue;
      sum += f[q];
      count += 1.0;
    }
    if (count > 0.0) out[v] = (1.0 - fraction) * f[v] + fraction * sum / count;
  }
  return out;
}

}  // namespace

Vec3 smoothed_mean_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                             const FaceGeometry& faces, std::span<const Vec3> mean_curvature,
                             std::span<const unsigned char> feature, Conventions conventions,
                             Index vertex) {
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for (const Index i : mesh.vertex_edges()[vertex]) {
    const Index q = other_end(mesh.edges()[i], vertex);
    if (conventions == Conventions::recommended && feature[q] == 0) continue;
    const double weight = angle_weight(mesh.edges()[i], vertex, positions, faces);
    sum += weight * mean_curvature[q];
    weights += weight;
  }
  if (weights == 0.0) return mean_curvature[vertex];
  return 0.5 * (mean_curvature[vertex] + sum / weights);
}

PrescribedCurvature prescribed_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                         const FaceGeometry& faces,
                                         std::span<const Vec3> mean_curvature,
                                         std::span<const unsigned char> feature, double mean_edge,
                                         const CurvatureSmoothing& smoothing,
                                         Conventions conventions) {
  PrescribedCurvature out;
  out.direction = volume_gradient(mesh, faces);
  out.value.resize(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    Vec3& direction = out.direction[v];
    if (feature[v] != 0) {
      const Vec3 smoothed =
          smoothed_mean_curvature(mesh, positions, faces, mean_curvature, feature, conventions, v);
      const double length = smoothed.norm();
      if (length >= kNoDirection * mean_edge) {
        direction = smoothed / (smoothed.dot(direction) < 0.0 ? -length : length);
      }
    }
    out.value[v] = curvature_value(mean_curvature[v], direction);
  }
  for (int pass = 0; pass < smoothing.passes; ++pass) {
    out.value = average(mesh, out.value, feature, smoothing.fraction, conventions);
  }
  return out;
}

}  // namespace fairway
