// Normals, areas, masses, volume and angle defect of a triangle surface.
// Sources: Hildebrandt & Polthier 2004 §2–3; Meyer et al. 2003 (mixed area).

#include "core/surface_geometry.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace fairway {
namespace {

/// Sums term(face, corner slot) over the faces at each vertex.
template <class T, class Term>
std::vector<T> sum_over_star(const TriangleMesh& mesh, const T& zero, const Term& term) {
  std::vector<T> sums(mesh.vertex_count(), zero);
  for (Index v = 0; v < sums.size(); ++v) {
    for (const Index f : mesh.vertex_faces()[v]) {
      const Triangle& face = mesh.faces()[f];
      const unsigned slot = face[0] == v ? 0U : face[1] == v ? 1U : 2U;
      sums[v] += term(f, slot);
    }
  }
  return sums;
}

/// A corner's share of its face's area, by Meyer's rule.
double mixed_share(const Vec3& p, const Vec3& q, const Vec3& r, double area) {
  const double at_p = (q - p).dot(r - p);
  const double at_q = (r - q).dot(p - q);
  const double at_r = (p - r).dot(q - r);
  if (at_p < 0.0) return area / 2.0;
  if (at_q < 0.0 || at_r < 0.0) return area / 4.0;
  const double twice = 2.0 * area;
  return ((q - p).squaredNorm() * at_r + (r - p).squaredNorm() * at_q) / (8.0 * twice);
}

/// A vector of two surfaces side by side: what is computed of both takes one register.
struct BeforeAndAfter {
  Eigen::Array2d x, y, z;
};

BeforeAndAfter operator-(const BeforeAndAfter& a, const BeforeAndAfter& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

BeforeAndAfter cross(const BeforeAndAfter& a, const BeforeAndAfter& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace

double mean_edge_length(const TriangleMesh& mesh, std::span<const Vec3> positions) {
  double sum = 0.0;
  std::size_t count = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    for (const Index q : mesh.rings()[v]) {
      if (q < v) continue;
      sum += (positions[q] - positions[v]).norm();
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

FaceGeometry face_geometry(const TriangleMesh& mesh, std::span<const Vec3> positions,
                           double smallest_area) {
  FaceGeometry out;
  out.normals.resize(mesh.faces().size(), Vec3::Zero());
  out.areas.resize(mesh.faces().size(), 0.0);
  for (Index f = 0; f < mesh.faces().size(); ++f) {
    const auto [a, b, c] = mesh.faces()[f];
    const Vec3 cross = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    const double twice_area = cross.norm();
    if (!(twice_area > 2.0 * smallest_area)) continue;
    out.areas[f] = 0.5 * twice_area;
    out.normals[f] = cross / twice_area;
  }
  return out;
}

std::vector<double> lumped_mass(const TriangleMesh& mesh, const FaceGeometry& faces) {
  return sum_over_star(mesh, 0.0,
                       [&faces](Index f, unsigned /*slot*/) { return faces.areas[f] / 3.0; });
}

std::vector<double> mixed_area(const TriangleMesh& mesh, std::span<const Vec3> positions,
                               const FaceGeometry& faces) {
  return sum_over_star(mesh, 0.0, [&](Index f, unsigned slot) {
    if (!faces.present(f)) return 0.0;
    const Triangle& t = mesh.faces()[f];
    return mixed_share(positions[t[slot]], positions[t[(slot + 1) % 3]],
                       positions[t[(slot + 2) % 3]], faces.areas[f]);
  });
}

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh, const FaceGeometry& faces) {
  std::vector<Vec3> normals = volume_gradient(mesh, faces);
  for (Vec3& n : normals) {
    const double length = n.norm();
    if (length > 0.0) n /= length;
  }
  return normals;
}

std::vector<Vec3> volume_gradient(const TriangleMesh& mesh, const FaceGeometry& faces) {
  return sum_over_star(mesh, Vec3(Vec3::Zero()), [&faces](Index f, unsigned /*slot*/) {
    return Vec3(faces.areas[f] / 3.0 * faces.normals[f]);
  });
}

std::vector<double> angle_defect(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                 const FaceGeometry& faces) {
  std::vector<double> defect = sum_over_star(mesh, 0.0, [&](Index f, unsigned slot) {
    if (!faces.present(f)) return 0.0;
    const Triangle& t = mesh.faces()[f];
    return -angle_at(positions[t[slot]], positions[t[(slot + 1) % 3]],
                     positions[t[(slot + 2) % 3]]);
  });
  for (std::size_t v = 0; v < defect.size(); ++v) {
    defect[v] += (mesh.boundary_vertex()[v] != 0 ? 1.0 : 2.0) * std::numbers::pi;
  }
  return defect;
}

double surface_area(const FaceGeometry& faces) {
  double sum = 0.0;
  for (const double a : faces.areas) sum += a;
  return sum;
}

double enclosed_volume(const TriangleMesh& mesh, std::span<const Vec3> positions) {
  double six = 0.0;
  for (const auto& [a, b, c] : mesh.faces()) {
    six += positions[a].dot(positions[b].cross(positions[c]));
  }
  return six / 6.0;
}

SurfaceChange surface_change(const TriangleMesh& mesh, std::span<const Vec3> before,
                             std::span<const Vec3> after, double smallest_area) {
  const double smallest_normal = 2.0 * smallest_area;
  const auto at = [before, after](Index v) {
    const Vec3& p = before[v];
    const Vec3& q = after[v];
    return BeforeAndAfter{{p.x(), q.x()}, {p.y(), q.y()}, {p.z(), q.z()}};
  };
  Eigen::Array2d six_volumes = Eigen::Array2d::Zero();
  Eigen::Array2d areas = Eigen::Array2d::Zero();
  std::size_t flipped = 0;
  for (const auto& [a, b, c] : mesh.faces()) {
    const BeforeAndAfter p = at(a);
    const BeforeAndAfter n = cross(at(b) - p, at(c) - p);
    six_volumes += p.x * n.x + p.y * n.y + p.z * n.z;
    const Eigen::Array2d twice_area = (n.x * n.x + n.y * n.y + n.z * n.z).sqrt();
    const bool present[] = {twice_area[0] > smallest_normal, twice_area[1] > smallest_normal};
    areas += Eigen::Array2d(present[0] ? twice_area[0] : 0.0, present[1] ? twice_area[1] : 0.0);
    const double turn = n.x[0] * n.x[1] + n.y[0] * n.y[1] + n.z[0] * n.z[1];
    flipped += present[0] && present[1] && turn < 0.0 ? 1U : 0U;
  }
  return {six_volumes[0] / 6.0, six_volumes[1] / 6.0, areas[0] / 2.0, areas[1] / 2.0, flipped};
}

double angle_at(const Vec3& at, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - at;
  const Vec3 v = b - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace fairway
