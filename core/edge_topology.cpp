// Edges as a list, for everything that goes edge by edge.

#include "core/edge_topology.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace fairway {
namespace {

/// Rows of the items whose ends `ends_of(item)` lists, each row ascending.
template <class EndsOf>
Adjacency gather(std::size_t rows, std::size_t item_count, const EndsOf& ends_of) {
  Adjacency adjacency;
  adjacency.offsets.assign(rows + 1, 0);
  for (Index item = 0; item < item_count; ++item) {
    for (const Index row : ends_of(item)) ++adjacency.offsets[row + 1];
  }
  std::partial_sum(adjacency.offsets.begin(), adjacency.offsets.end(), adjacency.offsets.begin());
  adjacency.items.resize(adjacency.offsets.back());
  std::vector<Index> next(adjacency.offsets.begin(), adjacency.offsets.end() - 1);
  for (Index item = 0; item < item_count; ++item) {
    for (const Index row : ends_of(item)) adjacency.items[next[row]++] = item;
  }
  return adjacency;
}

std::vector<Edge> list_edges(std::span<const Triangle> faces, const CornerTable& corners) {
  std::vector<Edge> edges;
  edges.reserve(3 * faces.size() / 2 + 1);
  for (Index c = 0; c < 3 * faces.size(); ++c) {
    const auto vertex = [faces](Index corner) { return faces[corner / 3][corner % 3]; };
    const Index a = vertex(c);
    const Index b = vertex(next_corner(c));
    const Index o = vertex(previous_corner(c));
    const Index other = corners.opposite[c];
    if (other == kNoIndex) {
      edges.push_back(a < b ? Edge{a, b, c / 3, kNoIndex, o, kNoIndex}
                            : Edge{b, a, kNoIndex, c / 3, kNoIndex, o});
    } else if (a < b) {
      edges.push_back({a, b, c / 3, other / 3, o, vertex(previous_corner(other))});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.p, a.q, a.face0, a.face1) < std::tie(b.p, b.q, b.face0, b.face1);
  });
  return edges;
}

}  // namespace

EdgeTopology edge_topology(std::span<const Triangle> faces, const CornerTable& corners,
                           std::size_t vertex_count) {
  EdgeTopology out;
  out.edges = list_edges(faces, corners);
  out.vertex_edges = gather(vertex_count, out.edges.size(), [&out](Index e) {
    return std::array{out.edges[e].p, out.edges[e].q};
  });
  out.vertex_faces =
      gather(vertex_count, faces.size(), [faces](Index f) -> const Triangle& { return faces[f]; });
  return out;
}

}  // namespace fairway
