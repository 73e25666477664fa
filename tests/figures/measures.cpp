// What the figures measure, on plain triangle lists, and the flow they compare with at boundaries.
// Sources: Desbrun, Meyer, Schröder, Barr 1999 for the cotangent flow; Ericson 2005 §5.1.5 for the
// closest point on a triangle.

#include "tests/figures/measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/curvature.h"
#include "core/triangle_mesh.h"

namespace fairway {
namespace {

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm();
}

double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  const auto within = [&](const Vec3& from, const Vec3& to) {
    return (to - from).cross(p - from).dot(normal) >= 0.0;
  };
  if (within(a, b) && within(b, c) && within(c, a)) return std::abs((p - a).dot(normal));
  return std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

}  // namespace

Result<IndexedMesh> after_flow(const IndexedMesh& mesh, const FlowOptions& options) {
  const Result<TriangleMesh> surface = TriangleMesh::build(mesh);
  if (!surface) return surface.error();
  const Result<Denoised> result = denoise(*surface, options);
  if (!result) return result.error();
  return IndexedMesh{surface->scatter_positions(mesh, result->positions), mesh.triangles};
}

Result<std::vector<double>> relative_curvature(const IndexedMesh& mesh) {
  const Result<TriangleMesh> surface = TriangleMesh::build(mesh);
  if (!surface) return surface.error();
  std::vector<double> values =
      scatter(*surface, curvature(*surface, surface->positions())).predominant;
  const double mean_edge = mean_edge_of(mesh);
  for (double& value : values) value = std::abs(value) * mean_edge;
  return values;
}

double volume_of(const IndexedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c]));
  }
  return sum / 6.0;
}

double area_of(const IndexedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& p = mesh.positions[a];
    sum += (mesh.positions[b] - p).cross(mesh.positions[c] - p).norm();
  }
  return 0.5 * sum;
}

double mean_edge_of(const IndexedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += (mesh.positions[a] - mesh.positions[b]).norm() +
           (mesh.positions[b] - mesh.positions[c]).norm() +
           (mesh.positions[c] - mesh.positions[a]).norm();
  }
  return sum / static_cast<double>(3 * mesh.triangles.size());
}

std::vector<double> distances(const IndexedMesh& mesh, const IndexedMesh& original) {
  std::vector<double> out;
  out.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : original.triangles) {
      const auto& x = original.positions;
      nearest = std::min(nearest, distance_to_triangle(p, x[a], x[b], x[c]));
    }
    out.push_back(nearest);
  }
  return out;
}

IndexedMesh cotangent_flow(IndexedMesh mesh, double step_size, int steps) {
  std::vector<Vec3>& x = mesh.positions;
  const double mean_edge = mean_edge_of(mesh);
  const double s = step_size * mean_edge * mean_edge;
  for (int step = 0; step < steps; ++step) {
    std::vector<Vec3> pull(x.size(), Vec3::Zero());
    std::vector<double> star(x.size(), 0.0);
    std::vector<double> stiffness(x.size(), 0.0);
    for (const Triangle& t : mesh.triangles) {
      const double twice_area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm();
      for (std::size_t k = 0; k < 3; ++k) {
        const Index o = t[k];
        const Index p = t[(k + 1) % 3];
        const Index q = t[(k + 2) % 3];
        const double cotangent = (x[p] - x[o]).dot(x[q] - x[o]) / twice_area;
        pull[p] += 0.5 * cotangent * (x[p] - x[q]);
        pull[q] += 0.5 * cotangent * (x[q] - x[p]);
        stiffness[p] += 0.5 * std::abs(cotangent);
        stiffness[q] += 0.5 * std::abs(cotangent);
        star[o] += 0.5 * twice_area;
      }
    }
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (star[v] > 0.0) x[v] -= std::min(3.0 * s / star[v], 0.5 / stiffness[v]) * pull[v];
    }
  }
  return mesh;
}

}  // namespace fairway
