// Measures of a denoised mesh against the clean one. A distance is exact to the faces whose
// centroids are nearest and to those of the nearest vertex: an upper bound of the true one.

#include "tests/quality/reference_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include <nanoflann.hpp>

namespace fairway::quality {
namespace {

constexpr std::size_t kCentroids = 12;
constexpr double kFeatureAngle = 30.0;
constexpr double kThinAngle = 0.5;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

Vec3 scaled_normal(std::span<const Vec3> x, const Triangle& f) {
  return (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
}

double angle_between(const Vec3& a, const Vec3& b) {
  return degrees(std::atan2(a.cross(b).norm(), a.dot(b)));
}

bool is_thin(std::span<const Vec3> x, const Triangle& f) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = x[f[(k + 1) % 3]] - x[f[k]];
    const Vec3 b = x[f[(k + 2) % 3]] - x[f[k]];
    if (!(a.norm() * b.norm() > 0.0) || angle_between(a, b) < kThinAngle) return true;
  }
  return false;
}

double volume(std::span<const Vec3> x, std::span<const Triangle> faces, const Vec3& about) {
  double sum = 0.0;
  for (const Triangle& f : faces) {
    sum += (x[f[0]] - about).dot((x[f[1]] - about).cross(x[f[2]] - about));
  }
  return sum / 6.0;
}

/// Squared distance to a triangle (Ericson 2004, 5.1.5).
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const auto far = [&p](const Vec3& q) { return (p - q).squaredNorm(); };
  const double d1 = ab.dot(p - a);
  const double d2 = ac.dot(p - a);
  if (d1 <= 0.0 && d2 <= 0.0) return far(a);
  const double d3 = ab.dot(p - b);
  const double d4 = ac.dot(p - b);
  if (d3 >= 0.0 && d4 <= d3) return far(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return far(a + ab * (d1 / (d1 - d3)));
  const double d5 = ab.dot(p - c);
  const double d6 = ac.dot(p - c);
  if (d6 >= 0.0 && d5 <= d6) return far(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return far(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return far(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  }
  const double sum = va + vb + vc;
  return far(a + ab * (vb / sum) + ac * (vc / sum));
}

struct Points {
  std::vector<Vec3> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>,
                                                 Points, 3, std::size_t>;

}  // namespace

struct ReferenceSurface::Trees {
  explicit Trees(const IndexedMesh& mesh) : vertices{mesh.positions}, centroids{{}} {
    for (const Triangle& f : mesh.triangles) {
      centroids.points.push_back(
          (mesh.positions[f[0]] + mesh.positions[f[1]] + mesh.positions[f[2]]) / 3.0);
    }
    of_vertices = std::make_unique<Tree>(3, vertices);
    of_centroids = std::make_unique<Tree>(3, centroids);
  }

  Points vertices, centroids;
  std::unique_ptr<Tree> of_vertices, of_centroids;
};

ReferenceSurface::ReferenceSurface(IndexedMesh mesh)
    : mesh_(std::move(mesh)), trees_(std::make_unique<Trees>(mesh_)) {
  const std::vector<Triangle>& faces = mesh_.triangles;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh_.positions) box.extend(p);
  diagonal_ = box.diagonal().norm();
  std::map<std::pair<Index, Index>, std::vector<Index>> edges;
  faces_of_.resize(mesh_.positions.size());
  for (Index f = 0; f < faces.size(); ++f) {
    normals_.push_back(scaled_normal(mesh_.positions, faces[f]));
    thin_.push_back(is_thin(mesh_.positions, faces[f]) ? 1 : 0);
    for (std::size_t k = 0; k < 3; ++k) {
      faces_of_[faces[f][k]].push_back(f);
      edges[std::minmax(faces[f][k], faces[f][(k + 1) % 3])].push_back(f);
    }
  }
  beside_feature_.assign(faces.size(), 0);
  closed_ = true;
  for (const auto& [ends, beside] : edges) {
    mean_edge_ += (mesh_.positions[ends.first] - mesh_.positions[ends.second]).norm();
    closed_ = closed_ && beside.size() == 2;
    if (beside.size() != 2) continue;
    if (angle_between(normals_[beside[0]], normals_[beside[1]]) <= kFeatureAngle) continue;
    for (const Index f : beside) beside_feature_[f] = 1;
  }
  mean_edge_ /= static_cast<double>(std::max<std::size_t>(edges.size(), 1));
}

ReferenceSurface::~ReferenceSurface() = default;
ReferenceSurface::ReferenceSurface(ReferenceSurface&&) noexcept = default;

double ReferenceSurface::distance(const Vec3& point) const {
  std::array<std::size_t, kCentroids> near{};
  std::array<double, kCentroids> squares{};
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const Triangle& f) {
    least = std::min(least, squared_distance(point, mesh_.positions[f[0]], mesh_.positions[f[1]],
                                             mesh_.positions[f[2]]));
  };
  const std::size_t found =
      trees_->of_centroids->knnSearch(point.data(), kCentroids, near.data(), squares.data());
  for (std::size_t i = 0; i < found; ++i) look_at(mesh_.triangles[near[i]]);
  if (trees_->of_vertices->knnSearch(point.data(), 1, near.data(), squares.data()) > 0) {
    for (const Index f : faces_of_[near[0]]) look_at(mesh_.triangles[f]);
  }
  return std::sqrt(least);
}

Comparison ReferenceSurface::compare(std::span<const Vec3> positions) const {
  Comparison out;
  std::size_t features = 0;
  for (std::size_t f = 0; f < normals_.size(); ++f) {
    const Triangle& face = mesh_.triangles[f];
    const double angle = angle_between(scaled_normal(positions, face), normals_[f]);
    out.normal_error += angle;
    if (angle > 90.0) ++out.flipped;
    if (thin_[f] == 0 && is_thin(positions, face)) ++out.degenerate;
    if (beside_feature_[f] == 0) continue;
    out.feature_error += angle;
    ++features;
  }
  out.normal_error /= static_cast<double>(normals_.size());
  if (features > 0) out.feature_error /= static_cast<double>(features);
  Vec3 center = Vec3::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const double far = distance(positions[v]) / diagonal_;
    out.mean_distance += far;
    out.largest_distance = std::max(out.largest_distance, far);
    out.displacement += (positions[v] - mesh_.positions[v]).norm() / mean_edge_;
    center += mesh_.positions[v];
  }
  const auto count = static_cast<double>(positions.size());
  out.mean_distance /= count;
  out.displacement /= count;
  center /= count;
  if (closed_) {
    out.volume_change = 100.0 * (volume(positions, mesh_.triangles, center) /
                                     volume(mesh_.positions, mesh_.triangles, center) -
                                 1.0);
  }
  return out;
}

}  // namespace fairway::quality
