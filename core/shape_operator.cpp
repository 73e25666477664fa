// The vertex shape operator, a sum of rank-one edge operators, and its principal axes.
// Source: Hildebrandt & Polthier 2004, eqs. (4), (5).

#include "core/shape_operator.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <utility>

namespace fairway {
namespace {

/// A symmetric 2×2 matrix on a tangent plane.
struct Symmetric2 {
  double xx = 0.0, xy = 0.0, yy = 0.0;
};

/// An orthonormal basis of the plane orthogonal to n (Duff et al. 2017), continuous off n_z = 0.
std::pair<Vec3, Vec3> tangent_basis(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  return {Vec3(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

/// Larger and smaller eigenvalue, and the unit eigenvector (cos, sin) of the larger.
struct Axes {
  double major, minor, cosine, sine;
};
Axes principal_axes(const Symmetric2& s) {
  const double mean = 0.5 * (s.xx + s.yy);
  const double half = 0.5 * (s.xx - s.yy);
  const double radius = std::hypot(half, s.xy);
  if (radius == 0.0) return {mean, mean, 1.0, 0.0};
  // Of the two equivalent eigenvector formulas, the one that does not cancel.
  const double c = half >= 0.0 ? half + radius : std::abs(s.xy);
  const double d = half >= 0.0 ? s.xy : std::copysign(radius - half, s.xy);
  const double length = std::hypot(c, d);
  return {mean + radius, mean - radius, c / length, d / length};
}

}  // namespace

ShapeOperator shape_operator(const TriangleMesh& mesh, std::span<const Vec3> positions,
                             const EdgeCurvature& edges, std::span<const Vec3> normals) {
  ShapeOperator out;
  const std::size_t n = mesh.vertex_count();
  out.major.resize(n, 0.0);
  out.minor.resize(n, 0.0);
  out.major_direction.resize(n, Vec3::Zero());
  out.minor_direction.resize(n, Vec3::Zero());
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3& normal = normals[v];
    if (normal.isZero()) continue;
    const auto [u, w] = tangent_basis(normal);
    Symmetric2 s;
    for (const Index i : mesh.vertex_edges()[v]) {
      const double h = edges.values[i];
      if (h == 0.0) continue;
      const Edge& e = mesh.edges()[i];
      const Vec3 edge_normal = edges.vectors[i] / h;
      const Vec3 across = (positions[e.q] - positions[e.p]).cross(edge_normal);
      const double x = across.dot(u);
      const double y = across.dot(w);
      const double squared = x * x + y * y;
      if (squared == 0.0) continue;
      const double scale = 0.5 * normal.dot(edge_normal) * h / squared;
      s.xx += scale * x * x;
      s.xy += scale * x * y;
      s.yy += scale * y * y;
    }
    const Axes axes = principal_axes(s);
    out.major[v] = axes.major;
    out.minor[v] = axes.minor;
    out.major_direction[v] = axes.cosine * u + axes.sine * w;
    out.minor_direction[v] = axes.cosine * w - axes.sine * u;
  }
  return out;
}

}  // namespace fairway
