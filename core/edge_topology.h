#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/corner_table.h"
#include "core/mesh.h"

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
constexpr Index other_end(const Edge& edge, Index v) {
  return edge.p == v ? edge.q : edge.p;
}

/// Compressed rows: the items of row i are items[offsets[i] .. offsets[i + 1]).
struct Adjacency {
  std::vector<Index> offsets;
  std::vector<Index> items;

  std::span<const Index> operator[](std::size_t row) const {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
};

/// The edges of a manifold triangle list and what is at each vertex.
struct EdgeTopology {
  std::vector<Edge> edges;  ///< boundary included, sorted by (p, q)
  Adjacency vertex_edges;   ///< ascending
  Adjacency vertex_faces;   ///< ascending
};

/// `corners` says which sides of `faces` are joined: two vertices may be the ends of several edges.
EdgeTopology edge_topology(std::span<const Triangle> faces, const CornerTable& corners,
                           std::size_t vertex_count);

}  // namespace fairway
