#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/edge_topology.h"
#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// An interior edge p–q between two faces with area: all that has a say in how it bends.
struct EdgeStencil {
  std::array<Index, 4> points;  ///< slots p, q, o0, o1; face 0 runs p→q, o_i is opposite in face i
  std::array<Index, 2> faces;
  Index edge;                  ///< number of p–q among all edges
  std::array<Index, 4> sides;  ///< edges p–o0, q–o0, p–o1, q–o1
};

/// A surface laid out for passes over edges and faces: vertices in Morton order ("slots"), faces
/// and edges by their least slot, so that what is near in space is near in memory. Immutable.
class EdgeStencils {
 public:
  explicit EdgeStencils(const TriangleMesh& mesh);

  std::size_t slot_count() const { return vertex_of_slot_.size(); }
  const std::vector<Index>& vertex_of_slot() const { return vertex_of_slot_; }
  const std::vector<Triangle>& faces() const { return faces_; }
  /// Ends of all edges, boundary included.
  const std::vector<std::array<Index, 2>>& edges() const { return edges_; }
  const std::vector<EdgeStencil>& stencils() const { return stencils_; }
  /// Per face the numbers of its up to three stencils; kNoIndex where it has none.
  const std::vector<std::array<Index, 3>>& stencils_of_face() const { return stencils_of_face_; }
  /// Per face its neighbours across these; itself where there is none.
  const std::vector<std::array<Index, 3>>& neighbours_of_face() const {
    return neighbours_of_face_;
  }
  /// Neighbours of each slot in order around it, see TriangleMesh::rings().
  const Adjacency& rings() const { return rings_; }
  /// 1 where a boundary edge ends.
  const std::vector<unsigned char>& boundary() const { return boundary_; }

  /// Values of surface vertices in the order of slots.
  template <class T>
  std::vector<T> by_slot(std::span<const T> of_vertex) const {
    std::vector<T> out;
    out.reserve(of_vertex.size());
    for (const Index v : vertex_of_slot_) out.push_back(of_vertex[v]);
    return out;
  }

 private:
  std::vector<Index> order_faces(const TriangleMesh& mesh);
  void order_edges(const TriangleMesh& mesh, std::span<const Index> face_numbers);
  void find_sides(const std::vector<std::array<Index, 3>>& edges_of_face);
  void make_rings(const TriangleMesh& mesh);

  std::vector<Index> vertex_of_slot_;
  std::vector<Index> slot_of_vertex_;
  std::vector<Triangle> faces_;
  std::vector<std::array<Index, 2>> edges_;
  std::vector<EdgeStencil> stencils_;
  std::vector<std::array<Index, 3>> stencils_of_face_;
  std::vector<std::array<Index, 3>> neighbours_of_face_;
  Adjacency rings_;
  std::vector<unsigned char> boundary_;
};

}  // namespace fairway
