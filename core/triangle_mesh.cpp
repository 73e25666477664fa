// From any triangle list to an oriented surface with one fan per vertex: weld, drop, join, split.
// Joining corners only across edges with exactly two oppositely directed faces makes every other
// edge a boundary, so non-manifold fans come apart by themselves.

#include "core/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <mutex>
#include <utility>

#include "core/spatial_order.h"
#include "core/surface_geometry.h"
#include "core/weld.h"

namespace fairway {
namespace {

// Beyond this, areas and their squares leave the range in which float32 attributes stay finite.
constexpr double kLargestCoordinate = 1e18;

Result<void> check_source(const IndexedMesh& source) {
  if (source.triangles.empty()) {
    return Error{ErrorCode::no_triangles, "The mesh has no triangles; send a triangle mesh."};
  }
  for (const Vec3& p : source.positions) {
    // Coordinate by coordinate: a maximum may lose a NaN.
    if (!(p.array().abs() <= kLargestCoordinate).all()) {
      return Error{ErrorCode::invalid_mesh,
                   "A coordinate is not a number or beyond 1e18; scale the mesh down."};
    }
  }
  return {};
}

/// The triangles that can be computed with, over places: those with three distinct ones.
std::vector<Triangle> proper_triangles(const std::vector<Triangle>& triangles,
                                       const std::vector<Index>& place, SurfaceCounts& counts) {
  std::vector<Triangle> faces;
  faces.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Triangle f = {place[t[0]], place[t[1]], place[t[2]]};
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) faces.push_back(f);
  }
  counts.degenerate_triangles = triangles.size() - faces.size();
  return faces;
}

/// Leaves out every face with the same three places as an earlier one.
void drop_duplicates(std::vector<Triangle>& faces, SurfaceCounts& counts) {
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
  std::size_t kept = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!repeated[i]) faces[kept++] = faces[i];
  }
  counts.duplicate_triangles = faces.size() - kept;
  faces.resize(kept);
}

}  // namespace

struct TriangleMesh::LazyEdges {
  std::once_flag once;
  CornerTable corners;  // until the edges are made
  EdgeTopology topology;
};

TriangleMesh::TriangleMesh() : lazy_edges_(std::make_shared<LazyEdges>()) {}

const EdgeTopology& TriangleMesh::edge_topology() const {
  std::call_once(lazy_edges_->once, [this] {
    lazy_edges_->topology = fairway::edge_topology(faces_, lazy_edges_->corners, vertex_count());
    lazy_edges_->corners = {};
  });
  return lazy_edges_->topology;
}

/// Numbers the fan of `start` as the next vertex: its corners get the number, its ring is written
/// as corners (one at each neighbour), counter-clockwise from a boundary edge if there is one.
void TriangleMesh::walk_fan(const CornerTable& corners, Index start) {
  const auto vertex = static_cast<Index>(place_of_vertex_.size());
  const std::size_t first = rings_.items.size();
  Index c = walk_once(corners, start, vertex);
  if (c == kNoIndex) {
    // An open fan begins at its other end.
    Index back = start;
    while ((back = corners.clockwise(start)) != kNoIndex) start = back;
    rings_.items.resize(first);
    c = walk_once(corners, start, vertex);
  }
  boundary_vertex_.push_back(c == kNoIndex ? 1 : 0);
  rings_.offsets.push_back(static_cast<Index>(rings_.items.size()));
}

/// Goes round counter-clockwise from `start`. Returns it, or kNoIndex at a boundary.
Index TriangleMesh::walk_once(const CornerTable& corners, Index start, Index vertex) {
  Index c = start;
  Index last = c;
  do {
    faces_[c / 3][c % 3] = vertex;
    rings_.items.push_back(next_corner(c));
    last = c;
    c = corners.counter_clockwise(c);
  } while (c != kNoIndex && c != start);
  if (c == kNoIndex) rings_.items.push_back(previous_corner(last));
  return c;
}

/// One vertex per place, if every place has one fan: the rule. Nothing is sorted then.
bool TriangleMesh::make_single_fans(const CornerTable& corners,
                                    const std::vector<Triangle>& place_faces,
                                    std::size_t place_count) {
  std::vector<Index> first(place_count, kNoIndex);
  for (auto f = static_cast<Index>(place_faces.size()); f-- > 0;) {
    for (Index slot = 3; slot-- > 0;) first[place_faces[f][slot]] = 3 * f + slot;
  }
  std::size_t walked = 0;
  for (Index p = 0; p < place_count; ++p) {
    if (first[p] == kNoIndex) continue;
    const std::size_t before = rings_.items.size();
    walk_fan(corners, first[p]);
    place_of_vertex_.push_back(p);
    // A ring has one neighbour more than faces where it is open.
    walked += rings_.items.size() - before - boundary_vertex_.back();
  }
  return walked == 3 * place_faces.size();
}

/// One vertex per fan, in the order of places, then of corners.
void TriangleMesh::make_all_fans(const CornerTable& corners,
                                 const std::vector<Triangle>& place_faces,
                                 std::size_t place_count) {
  const auto corner_count = static_cast<Index>(3 * place_faces.size());
  // Corners by place, each place's ascending: the walk starts at the first one not yet walked.
  std::vector<Index> end(place_count + 1, 0);
  for (const Triangle& f : place_faces) {
    for (const Index p : f) ++end[p];
  }
  Index sum = 0;
  for (Index& e : end) sum = std::exchange(e, sum) + sum;
  std::vector<Index> at_place(corner_count);
  for (Index c = 0; c < corner_count; ++c) at_place[end[place_faces[c / 3][c % 3]]++] = c;
  Index first = 0;
  for (Index p = 0; p < place_count; ++p) {
    std::size_t fans = 0;
    for (Index i = first; i < end[p]; ++i) {
      const Index c = at_place[i];
      if (faces_[c / 3][c % 3] != kNoIndex) continue;
      walk_fan(corners, c);
      place_of_vertex_.push_back(p);
      ++fans;
    }
    counts_.split += fans > 1 ? fans - 1 : 0;
    first = end[p];
  }
}

void TriangleMesh::make_vertices(const CornerTable& corners,
                                 const std::vector<Triangle>& place_faces,
                                 std::size_t place_count) {
  const auto begin = [&] {
    faces_.assign(place_faces.size(), {kNoIndex, kNoIndex, kNoIndex});
    rings_.items.clear();
    rings_.items.reserve(3 * place_faces.size() + 3 * place_faces.size() / 16);
    rings_.offsets.assign(1, 0);
    rings_.offsets.reserve(place_count + 1);
    place_of_vertex_.clear();
    boundary_vertex_.clear();
  };
  begin();
  if (!make_single_fans(corners, place_faces, place_count)) {
    begin();
    make_all_fans(corners, place_faces, place_count);
  }
  for (Index& item : rings_.items) item = faces_[item / 3][item % 3];
}

void TriangleMesh::map_back(const IndexedMesh& source, std::size_t place_count) {
  std::vector<Index> vertex_of_place(place_count, kNoIndex);
  for (Index v = 0; v < place_of_vertex_.size(); ++v) {
    Index& first = vertex_of_place[place_of_vertex_[v]];
    if (first == kNoIndex) first = v;
  }
  counts_.welded = source.positions.size() - place_count;
  vertex_of_source_.resize(source.positions.size());
  positions_.resize(place_of_vertex_.size());
  for (Index s = 0; s < source.positions.size(); ++s) {
    const Index place = place_of_source_[s];
    const Index first = vertex_of_place[place];
    vertex_of_source_[s] = first;
    if (first == kNoIndex) ++counts_.isolated;
    for (Index v = first; v < place_of_vertex_.size() && place_of_vertex_[v] == place; ++v) {
      positions_[v] = source.positions[s];
    }
  }
  for (const Vec3& p : positions_) origin_ += p / static_cast<double>(positions_.size());
  for (Vec3& p : positions_) p -= origin_;
}

/// No face has an area that counts: nothing on this mesh has a normal.
bool TriangleMesh::all_faces_flat() const {
  const double side = 2.0 * smallest_area(mean_edge_length_);
  return std::none_of(faces_.begin(), faces_.end(), [&](const Triangle& f) {
    const Vec3& a = positions_[f[0]];
    return (positions_[f[1]] - a).cross(positions_[f[2]] - a).norm() > side;
  });
}

Result<TriangleMesh> TriangleMesh::build(const IndexedMesh& source) {
  if (auto done = check_source(source); !done) return done.error();
  return build_welded(source, weld_equal_positions(source.positions));
}

Result<TriangleMesh> TriangleMesh::build(const IndexedMesh& source, Weld weld) {
  if (auto done = check_source(source); !done) return done.error();
  return build_welded(source, std::move(weld));
}

Result<TriangleMesh> TriangleMesh::build_welded(const IndexedMesh& source, Weld weld) {
  TriangleMesh mesh;
  mesh.counts_.source_vertices = source.positions.size();
  mesh.counts_.source_triangles = source.triangles.size();
  std::vector<Triangle> faces = proper_triangles(source.triangles, weld.place, mesh.counts_);
  if (faces.empty()) {
    return Error{ErrorCode::invalid_mesh,
                 "No triangle has three distinct corners; check that the coordinates did not "
                 "collapse (far from the origin float32 keeps few digits)."};
  }
  if (in_no_order(faces, weld.count)) order_in_space(source.positions, weld, faces);
  mesh.place_of_source_ = std::move(weld.place);
  CornerTable corners = corner_table(faces, weld.count);
  if (corners.may_have_duplicates) {
    drop_duplicates(faces, mesh.counts_);
    corners = corner_table(faces, weld.count);
  }
  mesh.counts_.boundary_edges = static_cast<std::size_t>(
      std::count(corners.opposite.begin(), corners.opposite.end(), kNoIndex));
  mesh.make_vertices(corners, faces, weld.count);
  mesh.lazy_edges_->corners = std::move(corners);
  mesh.map_back(source, weld.count);
  mesh.mean_edge_length_ = fairway::mean_edge_length(mesh, mesh.positions_);
  if (mesh.all_faces_flat()) {
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
    // Adding zero would turn −0 into 0.
    if (!displacement.isZero(0.0)) out[s] += displacement / static_cast<double>(v - first);
  }
  return out;
}

}  // namespace fairway
