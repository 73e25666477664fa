#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/corner_table.h"
#include "core/edge_topology.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/weld.h"

namespace fairway {

/// What building a surface from a triangle list had to do.
struct SurfaceCounts {
  std::size_t source_vertices = 0;
  std::size_t source_triangles = 0;
  std::size_t welded = 0;                ///< source vertices merged into another at their place
  std::size_t isolated = 0;              ///< source vertices that no usable triangle uses
  std::size_t degenerate_triangles = 0;  ///< fewer than three distinct places
  std::size_t duplicate_triangles = 0;   ///< same three places as an earlier one
  std::size_t split = 0;                 ///< copies made to part non-manifold fans
  std::size_t boundary_edges = 0;        ///< after splitting
};

/// An oriented surface for computing: vertices at distinct places joined by edges with at most two
/// faces of opposite direction, every vertex star one fan. Built from any IndexedMesh:
/// equal positions are welded (unless build() is told otherwise), degenerate and duplicate
/// triangles left out, corners joined only across edges with exactly two oppositely directed faces
/// (non-manifold fans become copies). Once it exists, the mathematics on it is total. Immutable;
/// vertices keep the order of their first appearance in the source, except in a large mesh that
/// comes in no order: that one's follow a Morton curve. May be read by several threads.
class TriangleMesh {
 public:
  /// Errors: no_triangles (no triangle with three distinct positions), invalid_mesh (all faces
  /// collinear or a coordinate beyond ±1e18).
  static Result<TriangleMesh> build(const IndexedMesh& source);
  /// The same with given places: `weld` has a class for each source vertex, numbered by first
  /// appearance, of vertices at equal positions each. What is not in one class stays apart: shells
  /// that touch, and cracks.
  static Result<TriangleMesh> build(const IndexedMesh& source, Weld weld);

  std::size_t vertex_count() const { return positions_.size(); }
  /// Positions relative to origin(), so that a mesh far away loses no digits.
  const std::vector<Vec3>& positions() const { return positions_; }
  const Vec3& origin() const { return origin_; }
  /// L of positions(), see mean_edge_length().
  double mean_edge_length() const { return mean_edge_length_; }
  const std::vector<Triangle>& faces() const { return faces_; }

  /// Neighbours of each vertex, counter-clockwise seen from outside. Neighbours k and k + 1 span a
  /// face with the vertex, and so do the last and the first, except at a boundary vertex, where the
  /// ring runs from one boundary edge to the other.
  const Adjacency& rings() const { return rings_; }
  /// 1 where a boundary edge ends.
  const std::vector<unsigned char>& boundary_vertex() const { return boundary_vertex_; }

  /// All edges, boundary included, sorted by (p, q), and what is at each vertex. Made when first
  /// asked for: the packed kernels do without.
  const std::vector<Edge>& edges() const { return edge_topology().edges; }
  const Adjacency& vertex_edges() const { return edge_topology().vertex_edges; }
  const Adjacency& vertex_faces() const { return edge_topology().vertex_faces; }

  const SurfaceCounts& counts() const { return counts_; }

  /// For each source vertex the place (weld class) it belongs to: unless build() was given others,
  /// equal for equal positions.
  const std::vector<Index>& place_of_source() const { return place_of_source_; }

  /// For each surface vertex its place, ascending: the copies of a place follow one another.
  const std::vector<Index>& place_of_vertex() const { return place_of_vertex_; }

  /// One surface vertex per source vertex (the first copy of its place), kNoIndex if isolated.
  const std::vector<Index>& vertex_of_source() const { return vertex_of_source_; }

  /// Source positions moved by what the surface vertices moved: copies of one place are averaged,
  /// so nothing cracks; a place that did not move keeps its source position bit for bit.
  /// `moved`: vertex_count() positions relative to origin(). Returns one position per source
  /// vertex.
  std::vector<Vec3> scatter_positions(const IndexedMesh& source, std::span<const Vec3> moved) const;

 private:
  struct LazyEdges;

  TriangleMesh();
  const EdgeTopology& edge_topology() const;
  void make_vertices(const CornerTable& corners, std::vector<Triangle> place_faces,
                     std::size_t place_count);
  bool places_are_vertices(const CornerTable& corners, const std::vector<Triangle>& place_faces,
                           std::size_t place_count);
  void split_places(const CornerTable& corners, const std::vector<Triangle>& place_faces,
                    std::size_t place_count);
  template <class Visit, class Neighbour>
  void add_fan(const CornerTable& corners, Index start, const Visit& visit,
               const Neighbour& neighbour);
  static Result<TriangleMesh> build_welded(const IndexedMesh& source, Weld weld);
  void map_back(const IndexedMesh& source, std::size_t place_count);
  bool all_faces_flat() const;

  Vec3 origin_ = Vec3::Zero();
  double mean_edge_length_ = 0.0;
  std::vector<Vec3> positions_;
  std::vector<Triangle> faces_;
  Adjacency rings_;
  std::vector<unsigned char> boundary_vertex_;
  std::vector<Index> place_of_source_;
  std::vector<Index> place_of_vertex_;
  std::vector<Index> vertex_of_source_;
  SurfaceCounts counts_;
  std::shared_ptr<LazyEdges> lazy_edges_;
};

}  // namespace fairway
