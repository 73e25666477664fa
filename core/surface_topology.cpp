#include "core/surface_topology.h"

#include <vector>

#include "core/union_find.h"

namespace fairway {
namespace {

std::size_t count_components(const TriangleMesh& mesh) {
  UnionFind sets(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    Index root = sets.find(v);
    for (const Index q : mesh.rings()[v]) {
      if (q < v) root = sets.unite_root(root, q);
    }
  }
  std::size_t count = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) count += sets.find(v) == v ? 1U : 0U;
  return count;
}

/// A boundary runs from each of its vertices on to the last of the vertex's ring.
std::size_t count_boundary_loops(const TriangleMesh& mesh) {
  std::vector<bool> seen(mesh.vertex_count(), false);
  std::size_t loops = 0;
  for (Index start = 0; start < mesh.vertex_count(); ++start) {
    if (mesh.boundary_vertex()[start] == 0 || seen[start]) continue;
    ++loops;
    for (Index v = start; !seen[v]; v = mesh.rings()[v].back()) seen[v] = true;
  }
  return loops;
}

}  // namespace

SurfaceTopology surface_topology(const TriangleMesh& mesh) {
  const std::size_t edges = mesh.rings().items.size() / 2;
  return {count_components(mesh), count_boundary_loops(mesh),
          static_cast<long>(mesh.vertex_count() + mesh.faces().size()) - static_cast<long>(edges)};
}

}  // namespace fairway
