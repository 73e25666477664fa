// Global topology by walking halfedges. The only file that includes OpenMesh.

#include "core/halfedge.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/union_find.h"

namespace fairway {
namespace {

using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

// Only connectivity counts here.
const HalfedgeMesh::Point kAnywhere(0.0F, 0.0F, 0.0F);

/// Halfedges, and the vertex of the surface that each of their vertices stands for.
struct Halfedges {
  HalfedgeMesh mesh;
  std::vector<Index> vertex;
};

/// The surface as halfedges. TriangleMesh has split all non-manifold fans, so every face finds its
/// place; a face between two slits of one edge, which halfedges cannot say, gets corners of its
/// own.
Halfedges halfedges(const TriangleMesh& mesh) {
  Halfedges out;
  out.mesh.reserve(mesh.vertex_count(), mesh.rings().items.size() / 2, mesh.faces().size());
  const auto add_vertex = [&out](Index v) {
    out.vertex.push_back(v);
    return out.mesh.add_vertex(kAnywhere);
  };
  for (Index v = 0; v < mesh.vertex_count(); ++v) add_vertex(v);
  omerr().disable();  // a face that is refused finds its place below
  for (const Triangle& face : mesh.faces()) {
    std::array<OpenMesh::VertexHandle, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = OpenMesh::VertexHandle(static_cast<int>(face[i]));
    if (out.mesh.add_face(corners[0], corners[1], corners[2]).is_valid()) continue;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = add_vertex(face[i]);
    out.mesh.add_face(corners[0], corners[1], corners[2]);
  }
  return out;
}

/// Walks over halfedges and adds up what it meets.
class TopologyWalk {
 public:
  explicit TopologyWalk(const TriangleMesh& surface)
      : surface_(surface), halfedges_(halfedges(surface)), sets_(halfedges_.mesh.n_vertices()) {
    for (const auto edge : halfedges_.mesh.edges()) {
      sets_.unite(static_cast<Index>(edge.v0().idx()), static_cast<Index>(edge.v1().idx()));
    }
  }

  HalfedgeTopology run();

 private:
  ComponentTopology& piece_of(OpenMesh::SmartVertexHandle vertex);
  BoundaryLoop walk_loop(OpenMesh::SmartHalfedgeHandle start);
  void walk_loops(HalfedgeTopology& out);

  const TriangleMesh& surface_;
  const Halfedges halfedges_;
  UnionFind sets_;
  std::vector<std::size_t> piece_;  ///< per representative of a set
  std::vector<ComponentTopology> pieces_;
  std::vector<bool> seen_;
};

ComponentTopology& TopologyWalk::piece_of(OpenMesh::SmartVertexHandle vertex) {
  std::size_t& piece = piece_[sets_.find(static_cast<Index>(vertex.idx()))];
  if (piece == kNoIndex) {
    piece = pieces_.size();
    pieces_.emplace_back();
  }
  return pieces_[piece];
}

BoundaryLoop TopologyWalk::walk_loop(OpenMesh::SmartHalfedgeHandle start) {
  const auto position = [this](OpenMesh::SmartVertexHandle v) -> const Vec3& {
    return surface_.positions()[halfedges_.vertex[static_cast<std::size_t>(v.idx())]];
  };
  BoundaryLoop loop;
  auto walk = start;
  do {
    seen_[static_cast<std::size_t>(walk.idx())] = true;
    ++loop.edges;
    loop.length += (position(walk.to()) - position(walk.from())).norm();
    walk = walk.next();
  } while (walk != start);
  return loop;
}

void TopologyWalk::walk_loops(HalfedgeTopology& out) {
  seen_.assign(halfedges_.mesh.n_halfedges(), false);
  for (const auto start : halfedges_.mesh.halfedges()) {
    if (!start.is_boundary() || seen_[static_cast<std::size_t>(start.idx())]) continue;
    out.loops.push_back(walk_loop(start));
    ++piece_of(start.from()).boundary_loops;
  }
  std::stable_sort(
      out.loops.begin(), out.loops.end(),
      [](const BoundaryLoop& a, const BoundaryLoop& b) { return a.length > b.length; });
}

HalfedgeTopology TopologyWalk::run() {
  const HalfedgeMesh& mesh = halfedges_.mesh;
  piece_.assign(mesh.n_vertices(), kNoIndex);
  HalfedgeTopology out;
  walk_loops(out);
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    ++piece_of(vertex).vertices;
    ++piece_of(vertex).euler_characteristic;
  }
  for (const auto edge : mesh.edges()) --piece_of(edge.v0()).euler_characteristic;
  for (const auto face : mesh.faces()) {
    ++piece_of(face.halfedge().from()).faces;
    ++piece_of(face.halfedge().from()).euler_characteristic;
  }
  out.components = pieces_.size();
  out.boundary_loops = out.loops.size();
  out.euler_characteristic = static_cast<long>(mesh.n_vertices()) -
                             static_cast<long>(mesh.n_edges()) + static_cast<long>(mesh.n_faces());
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const auto& a, const auto& b) { return a.faces > b.faces; });
  out.pieces = std::move(pieces_);
  return out;
}

}  // namespace

HalfedgeTopology halfedge_topology(const TriangleMesh& mesh) {
  return TopologyWalk(mesh).run();
}

}  // namespace fairway
