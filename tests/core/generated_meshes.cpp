// Meshes for the tests of the mathematics: irregular samplings, topologies, and the same surface
// written down differently.

#include "tests/core/generated_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/shapes.h"

namespace fairway::test {
namespace {

using Sides = std::map<std::pair<Index, Index>, std::size_t>;

Index third(const Triangle& t, Index a, Index b) {
  return t[0] != a && t[0] != b ? t[0] : t[1] != a && t[1] != b ? t[1] : t[2];
}

bool concave(const IndexedMesh& mesh, Index a, Index b, Index c, Index d) {
  const Vec3& p = mesh.positions[a];
  const Vec3 normal = (mesh.positions[b] - p).cross(mesh.positions[c] - p);
  return normal.dot(mesh.positions[d] - p) > 1e-14 * normal.norm();
}

/// Flips the concave edges of one pass; a vertex takes part in at most one flip.
bool flip_concave_edges(IndexedMesh& mesh) {
  Sides face_of;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      face_of[{mesh.triangles[f][k], mesh.triangles[f][(k + 1) % 3]}] = f;
    }
  }
  std::vector<bool> taken(mesh.positions.size(), false);
  bool flipped = false;
  for (const auto& [side, face] : face_of) {
    const auto [a, b] = side;
    if (a > b) continue;
    const std::size_t other = face_of.at({b, a});
    const Index c = third(mesh.triangles[face], a, b);
    const Index d = third(mesh.triangles[other], a, b);
    if (taken[a] || taken[b] || taken[c] || taken[d] || !concave(mesh, a, b, c, d)) continue;
    if (face_of.contains({c, d}) || face_of.contains({d, c})) continue;
    mesh.triangles[face] = {a, d, c};
    mesh.triangles[other] = {d, b, c};
    taken[a] = taken[b] = taken[c] = taken[d] = flipped = true;
  }
  return flipped;
}

/// The square grid of sheet(), inner vertices moved within it.
IndexedMesh jittered_sheet(Index n, double jitter, Random& random) {
  IndexedMesh mesh = sheet(n);
  for (Vec3& p : mesh.positions) {
    const Vec3 by = random.in_cube() * jitter * 2.0 / n;
    if (std::max(std::abs(p.x()), std::abs(p.y())) < 1.0 - 1e-9) p += Vec3(by.x(), by.y(), 0.0);
  }
  return mesh;
}

}  // namespace

Vec3 Random::in_cube() {
  const double x = uniform(-1.0, 1.0);
  const double y = uniform(-1.0, 1.0);
  return {x, y, uniform(-1.0, 1.0)};
}

IndexedMesh irregular_sphere(Index levels, double radius, double jitter, std::uint64_t seed) {
  IndexedMesh mesh = sphere(levels, 1.0);
  Random random(seed);
  const double edge =
      (mesh.positions[mesh.triangles[0][0]] - mesh.positions[mesh.triangles[0][1]]).norm();
  for (Vec3& p : mesh.positions) p = (p + jitter * edge * random.in_cube()).normalized();
  while (flip_concave_edges(mesh)) {
  }
  for (Vec3& p : mesh.positions) p *= radius;
  return mesh;
}

IndexedMesh cylinder(Index around, Index along, double radius, double jitter, std::uint64_t seed) {
  Random random(seed);
  const double turn = 2.0 * std::numbers::pi / around;
  IndexedMesh mesh;
  for (Index i = 0; i <= along; ++i) {
    for (Index j = 0; j < around; ++j) {
      const bool inner = i > 0 && i < along;
      const double by_angle = inner ? jitter * random.uniform(-1.0, 1.0) : 0.0;
      const double by_height = inner ? jitter * random.uniform(-1.0, 1.0) : 0.0;
      const double angle = turn * (j + by_angle);
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                  2.0 * (i + by_height) / along - 1.0);
    }
  }
  for (Index i = 0; i < along; ++i) {
    for (Index j = 0; j < around; ++j) {
      const Index next = (j + 1) % around;
      const Index a = i * around;
      const Index b = a + around;
      mesh.triangles.push_back({a + j, a + next, b + next});
      mesh.triangles.push_back({a + j, b + next, b + j});
    }
  }
  return mesh;
}

IndexedMesh saddle(Index n, double jitter, std::uint64_t seed) {
  Random random(seed);
  IndexedMesh mesh = jittered_sheet(n, jitter, random);
  for (Vec3& p : mesh.positions) p.z() = 0.5 * (p.x() * p.x() - p.y() * p.y());
  return mesh;
}

IndexedMesh pierced_block(Index n) {
  // Cells 5 × 3 × 1 without (1, 1) and (3, 1); a square of n × n on every side that shows.
  const auto solid = [](const Eigen::Vector3i& c) {
    const bool inside = (c.array() >= 0).all() && c.x() < 5 && c.y() < 3 && c.z() < 1;
    return inside && !(c.y() == 1 && (c.x() == 1 || c.x() == 3));
  };
  std::map<std::array<int, 3>, Index> index_of;
  IndexedMesh mesh;
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const auto [it, added] =
        index_of.try_emplace({at.x(), at.y(), at.z()}, static_cast<Index>(mesh.positions.size()));
    if (added) mesh.positions.emplace_back(at.cast<double>() / n);
    return it->second;
  };
  const int size = static_cast<int>(n);
  const auto add_side = [&](const Eigen::Vector3i& corner, int axis, bool up) {
    Eigen::Vector3i u = Eigen::Vector3i::Zero();
    Eigen::Vector3i v = Eigen::Vector3i::Zero();
    u[(axis + (up ? 1 : 2)) % 3] = v[(axis + (up ? 2 : 1)) % 3] = 1;
    for (int i = 0; i < size * size; ++i) {
      const Eigen::Vector3i at = corner * size + (i / size) * u + (i % size) * v;
      const Index a = vertex(at);
      const Index c = vertex(at + u + v);
      mesh.triangles.push_back({a, vertex(at + u), c});
      mesh.triangles.push_back({a, c, vertex(at + v)});
    }
  };
  for (int cell = 0; cell < 15; ++cell) {
    const Eigen::Vector3i at(cell % 5, cell / 5, 0);
    if (!solid(at)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i step = Eigen::Vector3i::Unit(axis);
      if (!solid(at + step)) add_side(at + step, axis, true);
      if (!solid(at - step)) add_side(at, axis, false);
    }
  }
  return mesh;
}

IndexedMesh scattered_tetrahedra(Index count, double side, std::uint64_t seed) {
  Random random(seed);
  IndexedMesh mesh;
  for (Index i = 0; i < count; ++i) {
    const Vec3 at = 0.5 * side * random.in_cube();
    const Index a = 4 * i;
    for (const Vec3& p : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}) {
      mesh.positions.emplace_back(at + p / std::sqrt(8.0) + 0.05 * random.in_cube());
    }
    for (const Triangle& t : {Triangle{a, a + 2, a + 1}, Triangle{a, a + 1, a + 3},
                              Triangle{a, a + 3, a + 2}, Triangle{a + 1, a + 2, a + 3}}) {
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

IndexedMesh moebius_strip(Index length) {
  IndexedMesh mesh;
  for (Index i = 0; i < length; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / length;
    for (const double w : {-0.3, 0.3}) {
      const double r = 1.0 + w * std::cos(0.5 * angle);
      mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle),
                                  w * std::sin(0.5 * angle));
    }
  }
  for (Index i = 0; i < length; ++i) {
    const bool last = i + 1 == length;
    const Index a = 2 * i;
    const Index c = last ? 1 : a + 2;
    const Index d = last ? 0 : a + 3;
    mesh.triangles.push_back({a, c, d});
    mesh.triangles.push_back({a, d, a + 1});
  }
  return mesh;
}

IndexedMesh wheel(Index valence) {
  IndexedMesh mesh;
  mesh.positions.emplace_back(0.0, 0.0, 0.3);
  for (Index i = 0; i < valence; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / valence;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % valence});
  }
  return mesh;
}

IndexedMesh open_book(Index pages) {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (Index i = 0; i < pages; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / pages;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    if (i % 2 == 0) mesh.triangles.push_back({0, 1, 2 + i});
    if (i % 2 == 1) mesh.triangles.push_back({1, 0, 2 + i});
  }
  return mesh;
}

void append(IndexedMesh& mesh, const IndexedMesh& other, const Vec3& offset) {
  const auto first = static_cast<Index>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.emplace_back(p + offset);
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

IndexedMesh transformed(const IndexedMesh& mesh, const Eigen::Affine3d& map) {
  IndexedMesh out = mesh;
  for (Vec3& p : out.positions) p = map * p;
  return out;
}

std::vector<Vec3> Relabelled::in_old_order(std::span<const Vec3> values) const {
  std::vector<Vec3> out;
  out.reserve(new_of_old.size());
  for (const Index v : new_of_old) out.push_back(values[v]);
  return out;
}

Relabelled relabelled(const IndexedMesh& mesh, std::uint64_t seed) {
  Random random(seed);
  const auto shuffle = [&random](auto& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random.below(i)]);
  };
  Relabelled out;
  out.new_of_old.resize(mesh.positions.size());
  std::iota(out.new_of_old.begin(), out.new_of_old.end(), Index{0});
  shuffle(out.new_of_old);
  out.mesh.positions.resize(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    out.mesh.positions[out.new_of_old[v]] = mesh.positions[v];
  }
  for (Triangle t : mesh.triangles) {
    std::rotate(t.begin(), t.begin() + random.below(3), t.end());
    for (Index& v : t) v = out.new_of_old[v];
    out.mesh.triangles.push_back(t);
  }
  shuffle(out.mesh.triangles);
  return out;
}

}  // namespace fairway::test
