// Generated shapes, deterministic noise, and the usual measure of a denoised mesh.

#include "core/shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace fairway {
namespace {

constexpr double kPi = std::numbers::pi;

/// Triangles of a grid that closes in both directions, vertex (i, j) at i · columns + j.
void close_grid(Index rows, Index columns, std::vector<Triangle>& triangles) {
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const Index a = i * columns + j;
      const Index b = (i + 1) % rows * columns + j;
      const Index c = (i + 1) % rows * columns + (j + 1) % columns;
      const Index d = i * columns + (j + 1) % columns;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
}

/// Cuts each triangle in four, new vertices half way along the edges.
IndexedMesh subdivide(const IndexedMesh& mesh) {
  IndexedMesh out;
  out.positions = mesh.positions;
  std::map<std::pair<Index, Index>, Index> middle_of;
  const auto middle = [&](Index a, Index b) {
    const auto [it, added] =
        middle_of.try_emplace(std::minmax(a, b), static_cast<Index>(out.positions.size()));
    if (added) out.positions.emplace_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return it->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Index ab = middle(a, b);
    const Index bc = middle(b, c);
    const Index ca = middle(c, a);
    for (const Triangle& t :
         {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}}) {
      out.triangles.push_back(t);
    }
  }
  return out;
}

IndexedMesh icosahedron() {
  const double g = std::numbers::phi;
  IndexedMesh mesh;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      mesh.positions.emplace_back(0.0, a, b);
      mesh.positions.emplace_back(a, b, 0.0);
      mesh.positions.emplace_back(b, 0.0, a);
    }
  }
  // Faces are the triples at mutual edge length 2, turned outward.
  const auto near = [&mesh](Index a, Index b) {
    return std::abs((mesh.positions[a] - mesh.positions[b]).norm() - 2.0) < 1e-9;
  };
  for (Index a = 0; a < 12; ++a) {
    for (Index b = a + 1; b < 12; ++b) {
      for (Index c = b + 1; c < 12; ++c) {
        if (!near(a, b) || !near(b, c) || !near(c, a)) continue;
        const auto& x = mesh.positions;
        const bool outward = x[a].dot(x[b].cross(x[c])) > 0.0;
        mesh.triangles.push_back(outward ? Triangle{a, b, c} : Triangle{a, c, b});
      }
    }
  }
  return mesh;
}

/// Box–Muller on mt19937_64: the standard distributions differ between libraries.
class Gaussian {
 public:
  explicit Gaussian(std::uint64_t seed) : engine_(seed) {}
  double operator()() {
    const double u = 1.0 - uniform();
    const double v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * kPi * v);
  }

 private:
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  std::mt19937_64 engine_;
};

Vec3 area_vector(const IndexedMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.positions[t[0]];
  return 0.5 * (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
}

/// Each inner edge counts twice, each boundary edge once.
double mean_side_length(const IndexedMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum += (mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]).norm();
    }
  }
  return sum / static_cast<double>(3 * mesh.triangles.size());
}

}  // namespace

IndexedMesh ring(Index around, Index side) {
  constexpr double kHalf = 0.22;
  constexpr std::array<std::array<double, 2>, 4> kCorner = {
      {{1.0 - kHalf, -kHalf}, {1.0 + kHalf, -kHalf}, {1.0 + kHalf, kHalf}, {1.0 - kHalf, kHalf}}};
  const Index columns = 8 * side;
  IndexedMesh mesh;
  for (Index i = 0; i < around; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const Index k = j / (2 * side);
      const double t = static_cast<double>(j % (2 * side)) / (2 * side);
      const double r = (1.0 - t) * kCorner[k][0] + t * kCorner[(k + 1) % 4][0];
      const double z = (1.0 - t) * kCorner[k][1] + t * kCorner[(k + 1) % 4][1];
      // Every other column is turned by half a segment: nearly equilateral triangles.
      const double angle = 2.0 * kPi * (i + 0.5 * (j % 2)) / around;
      mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  for (Index i = 0; i < around; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const Index a = i * columns + j;
      const Index b = (i + 1) % around * columns + j;
      const Index c = (i + 1) % around * columns + (j + 1) % columns;
      const Index d = i * columns + (j + 1) % columns;
      if (j % 2 == 0) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  }
  return mesh;
}

IndexedMesh sphere(Index levels, double radius) {
  IndexedMesh mesh = icosahedron();
  for (Index level = 0; level < levels; ++level) mesh = subdivide(mesh);
  for (Vec3& p : mesh.positions) p *= radius / p.norm();
  return mesh;
}

IndexedMesh octahedron(Index n) {
  // Vertices on the surface |x| + |y| + |z| = n with whole coordinates.
  IndexedMesh mesh;
  std::map<std::array<int, 3>, Index> index_of;
  const int size = static_cast<int>(n);
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [it, added] = index_of.try_emplace(at, static_cast<Index>(mesh.positions.size()));
    if (added) mesh.positions.push_back(Vec3(at[0], at[1], at[2]) / size);
    return it->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const std::array<int, 3> sign = {octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1};
    const bool flip = sign[0] * sign[1] * sign[2] < 0;
    const auto at = [&](int i, int j) {
      return vertex({sign[0] * i, sign[1] * j, sign[2] * (size - i - j)});
    };
    const auto add = [&](Index a, Index b, Index c) {
      mesh.triangles.push_back(flip ? Triangle{a, c, b} : Triangle{a, b, c});
    };
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size - i; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < size) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return mesh;
}

IndexedMesh torus(Index around, Index tube, double major_radius, double minor_radius) {
  IndexedMesh mesh;
  for (Index i = 0; i < around; ++i) {
    const double u = 2.0 * kPi * i / around;
    for (Index j = 0; j < tube; ++j) {
      const double v = 2.0 * kPi * j / tube;
      const double r = major_radius + minor_radius * std::cos(v);
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), minor_radius * std::sin(v));
    }
  }
  close_grid(around, tube, mesh.triangles);
  return mesh;
}

IndexedMesh sheet(Index n) {
  IndexedMesh mesh;
  for (Index i = 0; i <= n; ++i) {
    for (Index j = 0; j <= n; ++j) {
      mesh.positions.emplace_back(2.0 * i / n - 1.0, 2.0 * j / n - 1.0, 0.0);
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j;
      mesh.triangles.push_back({a, a + n + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + 1});
    }
  }
  return mesh;
}

IndexedMesh with_normal_noise(const IndexedMesh& mesh, double strength, std::uint64_t seed) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const Triangle& t : mesh.triangles) {
    for (const Index v : t) normals[v] += area_vector(mesh, t);
  }
  Gaussian gaussian(seed);
  const double scale = strength * mean_side_length(mesh);
  IndexedMesh out = mesh;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    out.positions[v] += scale * gaussian() * normals[v].normalized();
  }
  return out;
}

double mean_normal_error(const IndexedMesh& reference, const IndexedMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& t : reference.triangles) {
    const Vec3 a = area_vector(reference, t);
    const Vec3 b = area_vector(mesh, t);
    const bool flat = a.isZero(0.0) || b.isZero(0.0);
    sum += flat ? 0.5 * kPi : std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum * 180.0 / kPi / static_cast<double>(reference.triangles.size());
}

}  // namespace fairway
