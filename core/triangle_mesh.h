#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"

namespace fairway {

/// An edge p–q with p < q. Face 0 runs p→q, face 1 runs q→p; `opposite_i` is the third vertex of
/// face i. A boundary edge has one of the faces missing (kNoIndex).
struct Edge {
  Index p, q;
  Index face0, face1;
  Index opposite0, opposite1;

  bool interior() const { return face0 != kNoIndex && face1 != kNoIndex; }
};

/// The end of an edge that is not `v`.
constexpr Index other_end(const Edge& edge, Index v) { return edge.p == v ? edge.q : edge.p; }

/// Compressed rows: the items of row i are items[offsets[i] .. offsets[i + 1]).
struct Adjacency {
  std::vector<Index> offsets;
  std::vector<Index> items;

  std::span<const Index> operator[](std::size_t row) const {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
};

class UnionFind;

/// What building a surface from a triangle list had to do.
struct SurfaceCounts {
  std::size_t source_vertices = 0;
  std::size_t source_triangles = 0;
  std::size_t welded = 0;               ///< source vertices merged into another at their position
  std::size_t isolated = 0;             ///< source vertices that no usable triangle uses
  std::size_t degenerate_triangles = 0; ///< fewer than three distinct positions
  std::size_t duplicate_triangles = 0;  ///< same three positions as an earlier one
  std::size_t split = 0;                ///< copies made to part non-manifold fans
  std::size_t boundary_edges = 0;       ///< after splitting
};

/// An oriented surface for computing: vertices at distinct places joined by edges with at most two
/// faces of opposite direction, every vertex star one fan. Built from any IndexedMesh:
/// equal positions are welded, degenerate and duplicate triangles left out, corners joined only
/// across edges with exactly two oppositely directed faces (non-manifold fans become copies).
/// Once it exists, the mathematics on it is total. Immutable; vertices keep the order of their
/// first appearance in the source.
class TriangleMesh {
 public:
  /// Errors: no_triangles (no triangle with three distinct positions), invalid_mesh (all faces
  /// collinear or a coordinate beyond ±1e18).
  static Result<TriangleMesh> build(const IndexedMesh& source);

  std::size_t vertex_count() const { return positions_.size(); }
  /// Positions relative to origin(), so that a mesh far away loses no digits.
  const std::vector<Vec3>& positions() const { return positions_; }
  const Vec3& origin() const { return origin_; }
  const std::vector<Triangle>& faces() const { return faces_; }
  /// All edges, boundary included, sorted by (p, q).
  const std::vector<Edge>& edges() const { return edges_; }
  /// Faces at a vertex, ascending.
  const Adjacency& vertex_faces() const { return vertex_faces_; }
  /// Edges at a vertex, ascending.
  const Adjacency& vertex_edges() const { return vertex_edges_; }
  /// 1 where a boundary edge ends.
  const std::vector<unsigned char>& boundary_vertex() const { return boundary_vertex_; }
  const SurfaceCounts& counts() const { return counts_; }

  /// For each source vertex the place (weld class) it belongs to, equal for equal positions.
  const std::vector<Index>& place_of_source() const { return place_of_source_; }

  /// Source positions moved by what the surface vertices moved: copies of one place are averaged,
  /// so nothing cracks; a place that did not move keeps its source position bit for bit.
  /// `moved`: vertex_count() positions relative to origin(). Returns one position per source vertex.
  std::vector<Vec3> scatter_positions(const IndexedMesh& source, std::span<const Vec3> moved) const;

  /// One surface vertex per source vertex (the first copy of its place), kNoIndex if isolated.
  const std::vector<Index>& vertex_of_source() const { return vertex_of_source_; }

 private:
  TriangleMesh() = default;
  void number_vertices(UnionFind& fans, const std::vector<Triangle>& place_faces);
  void map_back(const IndexedMesh& source, std::size_t place_count);
  void connect();

  Vec3 origin_ = Vec3::Zero();
  std::vector<Vec3> positions_;
  std::vector<Triangle> faces_;
  std::vector<Edge> edges_;
  Adjacency vertex_faces_;
  Adjacency vertex_edges_;
  std::vector<unsigned char> boundary_vertex_;
  std::vector<Index> place_of_source_;
  std::vector<Index> place_of_vertex_;
  std::vector<Index> vertex_of_source_;
  SurfaceCounts counts_;
};

}  // namespace fairway
