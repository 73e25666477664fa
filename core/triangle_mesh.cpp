// From any triangle list to an oriented surface with one fan per vertex: weld, drop, join, split.
// Joining corners only across edges with exactly two oppositely directed faces makes every other
// edge a boundary, so non-manifold fans come apart by themselves.

#include "core/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/surface_geometry.h"
#include "core/union_find.h"

namespace fairway {
namespace {

// Beyond this, areas and their squares leave the range in which float32 attributes stay finite.
constexpr double kLargestCoordinate = 1e18;

/// The class of equal positions for each vertex, numbered by first appearance. Sorting, not
/// hashing: a hostile mesh cannot make it quadratic.
std::pair<std::vector<Index>, std::size_t> weld_equal_positions(const std::vector<Vec3>& positions) {
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  const auto less = [&positions](Index a, Index b) {
    for (int c = 0; c < 3; ++c) {
      if (positions[a][c] != positions[b][c]) return positions[a][c] < positions[b][c];
    }
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  // The first of a run of equals has the smallest index: it is the first to appear.
  std::vector<Index> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  std::vector<Index> place(positions.size());
  Index count = 0;
  for (Index i = 0; i < positions.size(); ++i) place[i] = first[i] == i ? count++ : place[first[i]];
  return {std::move(place), count};
}

/// The triangles that can be computed with, over places: three distinct ones, each set once.
std::vector<Triangle> usable_triangles(const std::vector<Triangle>& triangles,
                                       const std::vector<Index>& place, SurfaceCounts& counts) {
  std::vector<Triangle> faces;
  faces.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Triangle f = {place[t[0]], place[t[1]], place[t[2]]};
    if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) {
      ++counts.degenerate_triangles;
    } else {
      faces.push_back(f);
    }
  }
  std::vector<std::pair<Triangle, Index>> keys(faces.size());
  for (Index i = 0; i < faces.size(); ++i) {
    Triangle sorted = faces[i];
    std::sort(sorted.begin(), sorted.end());
    keys[i] = {sorted, i};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> repeated(faces.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first == keys[i - 1].first) repeated[keys[i].second] = true;
  }
  std::vector<Triangle> unique;
  unique.reserve(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!repeated[i]) unique.push_back(faces[i]);
  }
  counts.duplicate_triangles = faces.size() - unique.size();
  return unique;
}

/// The side of a face that runs between two places, `slot` being the corner it starts at.
struct Side {
  Index low, high;
  Index face;
  unsigned slot;
  bool ascending;  ///< runs low → high
};

/// All sides, those of one edge next to each other, edges ascending.
std::vector<Side> sorted_sides(const std::vector<Triangle>& faces) {
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (Index f = 0; f < faces.size(); ++f) {
    for (unsigned slot = 0; slot < 3; ++slot) {
      const Index a = faces[f][slot];
      const Index b = faces[f][(slot + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), f, slot, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  return sides;
}

/// Calls visit(first, count) for each edge's run of sides.
template <class Visit>
void for_each_edge(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) {
      ++end;
    }
    visit(i, end - i);
    i = end;
  }
}

/// Two faces, of opposite direction: the only edge across which a surface goes on.
bool is_manifold(const std::vector<Side>& sides, std::size_t first, std::size_t count) {
  return count == 2 && sides[first].ascending != sides[first + 1].ascending;
}

Index corner(const Side& side, bool low) {
  const bool start = side.ascending == low;
  return 3 * side.face + (start ? side.slot : (side.slot + 1) % 3);
}

/// Joins corners across manifold edges; each class of corners is one fan, one vertex.
UnionFind join_fans(const std::vector<Side>& sides, std::size_t face_count) {
  UnionFind fans(3 * face_count);
  for_each_edge(sides, [&](std::size_t i, std::size_t count) {
    if (!is_manifold(sides, i, count)) return;
    for (const bool low : {true, false}) fans.unite(corner(sides[i], low), corner(sides[i + 1], low));
  });
  return fans;
}

/// One boundary edge for a side without a partner.
Edge boundary_edge(const Side& side, const std::vector<Triangle>& faces) {
  const Triangle& f = faces[side.face];
  const Index a = f[side.slot];
  const Index b = f[(side.slot + 1) % 3];
  const Index o = f[(side.slot + 2) % 3];
  if (side.ascending) return {a, b, side.face, kNoIndex, o, kNoIndex};
  return {b, a, kNoIndex, side.face, kNoIndex, o};
}

std::vector<Edge> build_edges(const std::vector<Side>& sides, const std::vector<Triangle>& faces) {
  std::vector<Edge> edges;
  edges.reserve(sides.size() / 2 + 1);
  for_each_edge(sides, [&](std::size_t i, std::size_t count) {
    if (is_manifold(sides, i, count)) {
      const Side& up = sides[i].ascending ? sides[i] : sides[i + 1];
      const Side& down = sides[i].ascending ? sides[i + 1] : sides[i];
      Edge edge = boundary_edge(up, faces);
      edge.face1 = down.face;
      edge.opposite1 = faces[down.face][(down.slot + 2) % 3];
      edges.push_back(edge);
    } else {
      for (std::size_t k = i; k < i + count; ++k) edges.push_back(boundary_edge(sides[k], faces));
    }
  });
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.p, a.q, a.face0, a.face1) < std::tie(b.p, b.q, b.face0, b.face1);
  });
  return edges;
}

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

/// No face has an area that counts: nothing on this mesh has a normal.
bool all_faces_flat(const TriangleMesh& mesh) {
  const double smallest = smallest_area(mean_edge_length(mesh, mesh.positions()));
  const FaceGeometry faces = face_geometry(mesh, mesh.positions(), smallest);
  return std::all_of(faces.areas.begin(), faces.areas.end(), [](double a) { return a == 0.0; });
}

}  // namespace

void TriangleMesh::number_vertices(UnionFind& fans, const std::vector<Triangle>& place_faces) {
  // A root is the smallest corner of its fan, so sorting by (place, root) keeps the source's order.
  std::vector<std::pair<Index, Index>> roots;
  for (Index c = 0; c < 3 * place_faces.size(); ++c) {
    if (fans.find(c) == c) roots.emplace_back(place_faces[c / 3][c % 3], c);
  }
  std::sort(roots.begin(), roots.end());
  std::vector<Index> vertex_of_root(3 * place_faces.size(), kNoIndex);
  place_of_vertex_.resize(roots.size());
  for (Index v = 0; v < roots.size(); ++v) {
    vertex_of_root[roots[v].second] = v;
    place_of_vertex_[v] = roots[v].first;
    if (v > 0 && roots[v].first == roots[v - 1].first) ++counts_.split;
  }
  faces_.resize(place_faces.size());
  for (Index c = 0; c < 3 * place_faces.size(); ++c) {
    faces_[c / 3][c % 3] = vertex_of_root[fans.find(c)];
  }
}

void TriangleMesh::map_back(const IndexedMesh& source, std::size_t place_count) {
  std::vector<Index> vertex_of_place(place_count, kNoIndex);
  for (Index v = 0; v < place_of_vertex_.size(); ++v) {
    Index& first = vertex_of_place[place_of_vertex_[v]];
    if (first == kNoIndex) first = v;
  }
  vertex_of_source_.resize(source.positions.size());
  std::vector<bool> seen(place_count, false);
  positions_.resize(place_of_vertex_.size());
  for (Index s = 0; s < source.positions.size(); ++s) {
    const Index place = place_of_source_[s];
    vertex_of_source_[s] = vertex_of_place[place];
    if (vertex_of_source_[s] == kNoIndex) ++counts_.isolated;
    if (seen[place]) {
      ++counts_.welded;
      continue;
    }
    seen[place] = true;
    for (Index v = vertex_of_place[place];
         v < place_of_vertex_.size() && place_of_vertex_[v] == place; ++v) {
      positions_[v] = source.positions[s];
    }
  }
  for (const Vec3& p : positions_) origin_ += p / static_cast<double>(positions_.size());
  for (Vec3& p : positions_) p -= origin_;
}

void TriangleMesh::connect() {
  edges_ = build_edges(sorted_sides(faces_), faces_);
  vertex_faces_ = gather(vertex_count(), faces_.size(), [this](Index f) { return faces_[f]; });
  vertex_edges_ = gather(vertex_count(), edges_.size(),
                         [this](Index e) { return std::array{edges_[e].p, edges_[e].q}; });
  boundary_vertex_.assign(vertex_count(), 0);
  for (const Edge& edge : edges_) {
    if (edge.interior()) continue;
    boundary_vertex_[edge.p] = boundary_vertex_[edge.q] = 1;
    ++counts_.boundary_edges;
  }
}

Result<TriangleMesh> TriangleMesh::build(const IndexedMesh& source) {
  if (source.triangles.empty()) {
    return Error{ErrorCode::no_triangles, "The mesh has no triangles; send a triangle mesh."};
  }
  for (const Vec3& p : source.positions) {
    if (!(p.cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
      return Error{ErrorCode::invalid_mesh,
                   "A coordinate is not a number or beyond 1e18; scale the mesh down."};
    }
  }
  TriangleMesh mesh;
  mesh.counts_.source_vertices = source.positions.size();
  mesh.counts_.source_triangles = source.triangles.size();
  auto [place, place_count] = weld_equal_positions(source.positions);
  mesh.place_of_source_ = std::move(place);
  const std::vector<Triangle> place_faces =
      usable_triangles(source.triangles, mesh.place_of_source_, mesh.counts_);
  if (place_faces.empty()) {
    return Error{ErrorCode::invalid_mesh,
                 "No triangle has three distinct corners; check that the coordinates did not "
                 "collapse (far from the origin float32 keeps few digits)."};
  }
  UnionFind fans = join_fans(sorted_sides(place_faces), place_faces.size());
  mesh.number_vertices(fans, place_faces);
  mesh.map_back(source, place_count);
  mesh.connect();
  if (all_faces_flat(mesh)) {
    return Error{ErrorCode::invalid_mesh, "Every triangle has zero area; send a surface."};
  }
  return mesh;
}

std::vector<Vec3> TriangleMesh::scatter_positions(const IndexedMesh& source,
                                                  std::span<const Vec3> moved) const {
  std::vector<Vec3> out = source.positions;
  for (std::size_t s = 0; s < out.size(); ++s) {
    const Index first = vertex_of_source_[s];
    if (first == kNoIndex) continue;
    Vec3 displacement = Vec3::Zero();
    Index v = first;
    for (; v < vertex_count() && place_of_vertex_[v] == place_of_source_[s]; ++v) {
      displacement += moved[v] - positions_[v];
    }
    out[s] += displacement / static_cast<double>(v - first);
  }
  return out;
}

}  // namespace fairway
