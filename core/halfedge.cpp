// Global topology by walking halfedges. The only file that includes OpenMesh.

#include "core/halfedge.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <array>
#include <vector>

#include "core/union_find.h"

namespace fairway {
namespace {

using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

// Only connectivity counts here.
const HalfedgeMesh::Point kAnywhere(0.0F, 0.0F, 0.0F);

/// The surface as halfedges. TriangleMesh has split all non-manifold fans, so every face finds its
/// place; a face between two slits of one edge, which halfedges cannot say, gets corners of its
/// own.
HalfedgeMesh halfedges(const TriangleMesh& mesh) {
  HalfedgeMesh out;
  out.reserve(mesh.vertex_count(), mesh.rings().items.size() / 2, mesh.faces().size());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) out.add_vertex(kAnywhere);
  for (const auto& [a, b, c] : mesh.faces()) {
    std::array<OpenMesh::VertexHandle, 3> corners;
    const std::array<Index, 3> face = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = OpenMesh::VertexHandle(static_cast<int>(face[i]));
    if (out.add_face(corners[0], corners[1], corners[2]).is_valid()) continue;
    for (auto& corner : corners) corner = out.add_vertex(kAnywhere);
    out.add_face(corners[0], corners[1], corners[2]);
  }
  return out;
}

std::size_t count_boundary_loops(const HalfedgeMesh& mesh) {
  std::vector<bool> seen(mesh.n_halfedges(), false);
  std::size_t loops = 0;
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())]) continue;
    ++loops;
    auto walk = start;
    do {
      seen[static_cast<std::size_t>(walk.idx())] = true;
      walk = walk.next();
    } while (walk != start);
  }
  return loops;
}

std::size_t count_components(const HalfedgeMesh& mesh) {
  UnionFind sets(mesh.n_vertices());
  for (const auto edge : mesh.edges()) {
    sets.unite(static_cast<Index>(edge.v0().idx()), static_cast<Index>(edge.v1().idx()));
  }
  std::size_t count = 0;
  for (const auto vertex : mesh.vertices()) {
    const auto v = static_cast<Index>(vertex.idx());
    if (!mesh.is_isolated(vertex) && sets.find(v) == v) ++count;
  }
  return count;
}

}  // namespace

SurfaceTopology halfedge_topology(const TriangleMesh& mesh) {
  const HalfedgeMesh halfedge_mesh = halfedges(mesh);
  SurfaceTopology out;
  out.components = count_components(halfedge_mesh);
  out.boundary_loops = count_boundary_loops(halfedge_mesh);
  out.euler_characteristic = static_cast<long>(halfedge_mesh.n_vertices()) -
                             static_cast<long>(halfedge_mesh.n_edges()) +
                             static_cast<long>(halfedge_mesh.n_faces());
  return out;
}

}  // namespace fairway
