// A stylised head as a star-shaped surface: a radius for every direction.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/shapes.h"
#include "tests/figures/models.h"

namespace fairway {
namespace {

double bump(double x, double y, double x0, double y0, double width, double height) {
  const double u = (x - x0) / width;
  const double v = (y - y0) / height;
  return std::exp(-(u * u + v * v));
}

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Relief of the face; x to the left of the head and y up, both direction cosines, mirror
/// symmetric in x. Tents (|x| without rounding) are creases.
double face_relief(double x, double y) {
  const double side = std::abs(x);
  double r = 0.0;
  // Brows: a crease that arches over the eyes.
  const double brow = y - 0.22 - 0.28 * side * (1.0 - 1.5 * side);
  r += 0.075 * std::exp(-std::abs(brow) / 0.10) * std::exp(-std::pow(side / 0.52, 6.0));
  // Sockets with eyeballs in them.
  r -= 0.085 * bump(side, y, 0.30, 0.10, 0.17, 0.11);
  r += 0.060 * bump(side, y, 0.30, 0.09, 0.10, 0.065);
  // Nose: a tent that widens and rises from the root to the tip, cut off below it.
  const double down = smooth_step(0.24, -0.24, y);
  const double width = 0.10 + 0.12 * down;
  const double under = smooth_step(-0.34, -0.26, y);
  r +=
      (0.04 + 0.21 * down) * under * smooth_step(0.34, 0.18, y) * std::max(0.0, 1.0 - side / width);
  r += 0.035 * bump(side, y, 0.11, -0.24, 0.06, 0.05);
  // Lips and the crease between them.
  r += 0.055 * bump(side, y, 0.0, -0.43, 0.20, 0.05) + 0.06 * bump(side, y, 0.0, -0.53, 0.16, 0.05);
  r -= 0.05 * std::exp(-std::abs(y + 0.48 - 0.06 * side) / 0.025) *
       std::exp(-std::pow(side / 0.20, 4.0));
  // Cheeks and chin.
  r += 0.05 * bump(side, y, 0.48, -0.12, 0.20, 0.16);
  r += 0.11 * bump(side, y, 0.0, -0.70, 0.20, 0.12);
  return r;
}

/// A C-shaped rim at the side of the head.
double ear_relief(const Vec3& d) {
  const double u = (d.z() + 0.08) / 0.17;
  const double v = (d.y() - 0.03) / 0.25;
  const double rho = std::hypot(u, v);
  const double rim = bump(rho, 0.0, 0.8, 0.0, 0.32, 1.0);
  return 0.11 * rim * smooth_step(0.75, 0.9, std::abs(d.x())) *
         (1.0 - 0.5 * smooth_step(0.2, 0.7, u));
}

double radius(const Vec3& d) {
  // An ellipsoid, narrower at the jaw.
  const double jaw = 1.0 - 0.16 * smooth_step(0.1, -0.8, d.y());
  const Vec3 axes(0.76 * jaw, 1.02, 0.92 * jaw);
  double r = 1.0 / d.cwiseQuotient(axes).norm();
  r += face_relief(d.x(), d.y()) * smooth_step(0.15, 0.5, d.z());
  r += ear_relief(d);
  r += 0.07 * bump(d.x(), d.y(), 0.0, 0.25, 0.6, 0.5) * smooth_step(-0.3, -0.8, d.z());
  // The neck tapers, so that directions meet it less at a slant, and is cut flat.
  constexpr double kTaper = 0.3;
  const double off_axis = std::hypot(d.x(), d.z() + 0.18 * d.y());
  const double neck = (0.50 + 0.7 * kTaper) / (off_axis - kTaper * d.y());
  if (d.y() < -0.55) r = std::max(r, std::min(neck, -1.14 / d.y()));
  return r;
}

/// The icosahedron with each face cut n × n, on the unit sphere.
IndexedMesh geodesic_sphere(int n) {
  const IndexedMesh coarse = sphere(0, 1.0);
  IndexedMesh out;
  // A vertex is known by the corners it lies between and its weights of them.
  using Key = std::array<std::pair<Index, int>, 3>;
  std::map<Key, Index> index_of;
  for (const Triangle& t : coarse.triangles) {
    const auto vertex = [&](int i, int j) {
      const std::array<int, 3> weight = {n - i - j, i, j};
      Key key;
      Vec3 p = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        key[k] = weight[k] == 0 ? std::pair{kNoIndex, 0} : std::pair{t[k], weight[k]};
        p += weight[k] * coarse.positions[t[k]];
      }
      std::ranges::sort(key);
      const auto [it, added] = index_of.try_emplace(key, static_cast<Index>(out.positions.size()));
      if (added) out.positions.push_back(p.normalized());
      return it->second;
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n - i; ++j) {
        out.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
        if (i + j + 2 > n) continue;
        out.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
    }
  }
  return out;
}

}  // namespace

IndexedMesh head(int n) {
  IndexedMesh mesh = geodesic_sphere(n);
  for (Vec3& p : mesh.positions) p *= radius(p);
  return mesh;
}

}  // namespace fairway
