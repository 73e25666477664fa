// A software rasteriser: barycentric coverage at sample centres, depth buffer, headlight.

#include "tests/figures/rasteriser.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fairway {
namespace {

constexpr double kAmbient = 0.28;

Vec3 area_vector(const IndexedMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
}

std::vector<Vec3> smooth_normals(const IndexedMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const Triangle& t : mesh.triangles) {
    for (const Index v : t) normals[v] += area_vector(mesh, t);
  }
  return normals;
}

/// Twice the signed area of (a, b, p) in the plane of the picture.
double side_of(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

Rasteriser::Rasteriser(int width, int height, int samples, const Camera& camera)
    : factor_(samples),
      samples_(width * samples, height * samples),
      depth_(static_cast<std::size_t>(width * height * samples * samples),
             std::numeric_limits<double>::infinity()),
      target_(camera.target),
      right_(camera.direction.cross(camera.up).normalized()),
      up_(right_.cross(camera.direction).normalized()),
      forward_(camera.direction.normalized()),
      scale_(0.5 * height * samples / camera.half_height) {}

Vec3 Rasteriser::to_screen(const Vec3& p) const {
  const Vec3 d = p - target_;
  return {0.5 * samples_.width() + scale_ * d.dot(right_),
          0.5 * samples_.height() - scale_ * d.dot(up_), scale_ * d.dot(forward_)};
}

double Rasteriser::light_on(const Vec3& normal) const {
  const double length = normal.norm();
  const double cosine = length > 0.0 ? std::abs(normal.dot(forward_)) / length : 0.0;
  return kAmbient + (1.0 - kAmbient) * cosine;
}

void Rasteriser::draw(const IndexedMesh& mesh, std::span<const Rgb> colours, Shading shading) {
  const bool smooth = shading == Shading::smooth;
  const std::vector<Vec3> normals = smooth ? smooth_normals(mesh) : std::vector<Vec3>();
  for (const Triangle& t : mesh.triangles) {
    const double facet_light = light_on(area_vector(mesh, t));
    std::array<Corner, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Rgb& c = colours[t[k]];
      corners[k] = {to_screen(mesh.positions[t[k]]), Vec3(c.r, c.g, c.b),
                    smooth ? light_on(normals[t[k]]) : facet_light};
    }
    fill(corners);
  }
}

void Rasteriser::fill(const std::array<Corner, 3>& corners) {
  const auto& [a, b, c] = corners;
  const double area = side_of(a.screen, b.screen, c.screen.x(), c.screen.y());
  if (area == 0.0) return;
  const auto [left, right] = std::minmax({a.screen.x(), b.screen.x(), c.screen.x()});
  const auto [top, bottom] = std::minmax({a.screen.y(), b.screen.y(), c.screen.y()});
  const int last_x = std::min(samples_.width() - 1, static_cast<int>(std::floor(right)));
  const int last_y = std::min(samples_.height() - 1, static_cast<int>(std::floor(bottom)));
  for (int y = std::max(0, static_cast<int>(std::floor(top))); y <= last_y; ++y) {
    for (int x = std::max(0, static_cast<int>(std::floor(left))); x <= last_x; ++x) {
      const double u = side_of(b.screen, c.screen, x + 0.5, y + 0.5) / area;
      const double v = side_of(c.screen, a.screen, x + 0.5, y + 0.5) / area;
      const double w = 1.0 - u - v;
      if (u < 0.0 || v < 0.0 || w < 0.0) continue;
      const double depth = u * a.screen.z() + v * b.screen.z() + w * c.screen.z();
      double& nearest = depth_[static_cast<std::size_t>(y * samples_.width() + x)];
      if (depth >= nearest) continue;
      nearest = depth;
      const Vec3 lit =
          (u * a.light + v * b.light + w * c.light) * (u * a.colour + v * b.colour + w * c.colour);
      samples_.at(x, y) = {to_byte(lit.x()), to_byte(lit.y()), to_byte(lit.z())};
    }
  }
}

void Rasteriser::draw_line(std::span<const Vec3> points, double width, Rgb colour) {
  const double radius = 0.5 * width * factor_;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec3 from = to_screen(points[k]);
    const Vec3 to = to_screen(points[k + 1]);
    // Dots half a sample apart.
    const int dots = 1 + static_cast<int>(2.0 * (to - from).head<2>().norm());
    for (int i = 0; i <= dots; ++i) {
      const Vec3 p = from + (to - from) * i / dots;
      for (int y = static_cast<int>(p.y() - radius); y <= static_cast<int>(p.y() + radius); ++y) {
        for (int x = static_cast<int>(p.x() - radius); x <= static_cast<int>(p.x() + radius); ++x) {
          const bool within = x >= 0 && x < samples_.width() && y >= 0 && y < samples_.height() &&
                              std::hypot(x + 0.5 - p.x(), y + 0.5 - p.y()) <= radius;
          if (within) samples_.at(x, y) = colour;
        }
      }
    }
  }
}

}  // namespace fairway
