// Edge-based mean curvature, its weight, and what both say about noise and features.
// Source: Hildebrandt & Polthier 2004, eqs. (2)–(6), §5 of the resolved formulas for the noise.

#include "core/edge_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/median.h"
#include "core/union_find.h"

namespace fairway {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Median of |x| for a standard normal x.
constexpr double kMedianOfNormal = 0.6745;
// Standard deviation of β for white normal noise of one mean edge length, on equilateral triangles.
constexpr double kBendOfUnitNoise = 2.309;

}  // namespace

EdgeCurvature edge_mean_curvature(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                  const FaceGeometry& faces) {
  EdgeCurvature out;
  const std::size_t count = mesh.edges().size();
  out.vectors.resize(count, Vec3::Zero());
  out.values.resize(count, 0.0);
  out.dihedral_angles.resize(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const Edge& e = mesh.edges()[i];
    if (!e.interior() || !faces.present(e.face0) || !faces.present(e.face1)) continue;
    const Vec3& n0 = faces.normals[e.face0];
    const Vec3& n1 = faces.normals[e.face1];
    const Vec3 difference = n0 - n1;
    out.vectors[i] = (positions[e.q] - positions[e.p]).cross(difference);
    const double sign = out.vectors[i].dot(n0 + n1) < 0.0 ? -1.0 : 1.0;
    out.values[i] = sign * out.vectors[i].norm();
    out.dihedral_angles[i] = sign * 2.0 * std::asin(std::min(1.0, 0.5 * difference.norm()));
  }
  return out;
}

double edge_weight(double edge_mean_curvature, double lambda, double transition) {
  const double a = std::abs(edge_mean_curvature);
  if (a <= lambda) return 1.0;
  // In units of λ: no overflow for tiny or huge meshes.
  const double excess = a / lambda - 1.0;
  return 1.0 / (transition * excess * excess + 1.0);
}

double lambda_of_feature_angle(double degrees, double mean_edge) {
  return 2.0 * mean_edge * std::sin(0.5 * degrees * kDegree);
}

double feature_angle_of_lambda(double lambda, double mean_edge) {
  return 2.0 * std::asin(std::clamp(lambda / (2.0 * mean_edge), 0.0, 1.0)) / kDegree;
}

std::vector<Vec3> mean_curvature_vector(const TriangleMesh& mesh, const EdgeCurvature& edges,
                                        std::span<const double> weights) {
  std::vector<Vec3> out(mesh.vertex_count(), Vec3::Zero());
  for (std::size_t v = 0; v < out.size(); ++v) {
    for (const Index e : mesh.vertex_edges()[v]) {
      out[v] += (weights.empty() ? 0.5 : 0.5 * weights[e]) * edges.vectors[e];
    }
  }
  return out;
}

double robust_bend(const TriangleMesh& mesh, const EdgeCurvature& edges) {
  std::vector<double> bends;
  bends.reserve(edges.values.size());
  for (std::size_t i = 0; i < edges.values.size(); ++i) {
    if (mesh.edges()[i].interior()) bends.push_back(std::abs(edges.dihedral_angles[i]));
  }
  return median(bends) / kMedianOfNormal;
}

double noise_estimate(double robust_bend) {
  return robust_bend / kBendOfUnitNoise;
}

Features detect_features(const TriangleMesh& mesh, const EdgeCurvature& edges, double lambda,
                         double transition, int min_component) {
  Features out;
  out.weights.resize(mesh.edges().size(), 1.0);
  out.vertex.resize(mesh.vertex_count(), 0);
  const auto strong = [&](std::size_t i) { return std::abs(edges.values[i]) > lambda; };
  UnionFind groups(mesh.vertex_count());
  std::vector<int> group_size(mesh.vertex_count(), 1);
  if (min_component > 2) {
    for (std::size_t i = 0; i < mesh.edges().size(); ++i) {
      if (strong(i)) groups.unite(mesh.edges()[i].p, mesh.edges()[i].q);
    }
    std::fill(group_size.begin(), group_size.end(), 0);
    for (Index v = 0; v < mesh.vertex_count(); ++v) ++group_size[groups.find(v)];
  }
  for (std::size_t i = 0; i < mesh.edges().size(); ++i) {
    if (!strong(i)) continue;
    const Edge& e = mesh.edges()[i];
    if (min_component > 2 && group_size[groups.find(e.p)] < min_component) continue;
    out.weights[i] = edge_weight(edges.values[i], lambda, transition);
    out.vertex[e.p] = out.vertex[e.q] = 1;
  }
  return out;
}

}  // namespace fairway
