#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway::test {

/// The same numbers on every platform: the standard distributions differ between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, count).
  Index below(std::size_t count) { return static_cast<Index>(engine_() % count); }
  bool chance(double probability) { return uniform() < probability; }
  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In the cube [−1, 1]³.
  Vec3 in_cube();

 private:
  std::mt19937_64 engine_;
};

/// Sphere about the origin whose vertices are moved about by up to `jitter` mean edges and whose
/// edges are flipped until the surface is convex: valences from 4 to 9.
IndexedMesh irregular_sphere(Index levels, double radius, double jitter, std::uint64_t seed);

/// Open cylinder x² + y² = radius² of length 2 along z; inner vertices moved within the surface by
/// up to `jitter` of an edge.
IndexedMesh cylinder(Index around, Index along, double radius, double jitter, std::uint64_t seed);

/// The graph z = (x² − y²) / 2 over [−1, 1]², inner vertices moved by up to `jitter` of an edge.
IndexedMesh saddle(Index n, double jitter, std::uint64_t seed);

/// A block with two holes: genus 2, closed, `n` vertices a cell's side.
IndexedMesh pierced_block(Index n);

/// Nearly regular tetrahedra with edges of about 1, at random places of a cube of size `side`. No
/// edge bends by 120°, so that nothing is unfolded.
IndexedMesh scattered_tetrahedra(Index count, double side, std::uint64_t seed);

/// A closed strip of `length` quads with half a turn: it has one side and so no orientation.
IndexedMesh moebius_strip(Index length);

/// `valence` triangles around one vertex, closed.
IndexedMesh wheel(Index valence);

/// `pages` sheets that share one edge: non-manifold for more than two.
IndexedMesh open_book(Index pages);

/// Appends `other`, moved by `offset`; no vertex becomes shared.
void append(IndexedMesh& mesh, const IndexedMesh& other, const Vec3& offset);

/// Every position p ↦ map · p.
IndexedMesh transformed(const IndexedMesh& mesh, const Eigen::Affine3d& map);

/// Vertices and triangles in random order, every triangle's corners turned at random.
struct Relabelled {
  IndexedMesh mesh;
  std::vector<Index> new_of_old;

  /// Values of the new vertices in the old order.
  std::vector<Vec3> in_old_order(std::span<const Vec3> values) const;
};
Relabelled relabelled(const IndexedMesh& mesh, std::uint64_t seed);

}  // namespace fairway::test
