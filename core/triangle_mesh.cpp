// From any triangle list to an oriented surface with one fan per vertex: weld, drop, join, split.
// Joining corners only across edges with exactly two oppositely directed faces makes every other
// edge a boundary, so non-manifold fans come apart by themselves.

#include "core/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <mutex>
#include <numeric>
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

/// Adds the fan of `start` as the next vertex: visit(corner) is called for its corners, its ring is
/// written as neighbour(corner at the neighbour), counter-clockwise from a boundary edge if there
/// is one.
template <class Visit, class Neighbour>
void TriangleMesh::add_fan(const CornerTable& corners, Index start, const Visit& visit,
                           const Neighbour& neighbour) {
  const auto go_round = [&](Index from) {
    Index c = from;
    Index last = c;
    do {
      visit(c);
      rings_.items.push_back(neighbour(next_corner(c)));
      last = c;
      c = corners.counter_clockwise(c);
    } while (c != kNoIndex && c != from);
    if (c == kNoIndex) rings_.items.push_back(neighbour(previous_corner(last)));
    return c;
  };
  const std::size_t first = rings_.items.size();
  const bool open = go_round(start) == kNoIndex;
  if (open) {
    // An open fan begins at its other end.
    Index back = start;
    while ((back = corners.clockwise(start)) != kNoIndex) start = back;
    rings_.items.resize(first);
    go_round(start);
  }
  boundary_vertex_.push_back(open ? 1 : 0);
  rings_.offsets.push_back(static_cast<Index>(rings_.items.size()));
}

/// Vertices are the places, if each has one fan and no more: the rule. Nothing is sorted then.
bool TriangleMesh::places_are_vertices(const CornerTable& corners,
                                       const std::vector<Triangle>& place_faces,
                                       std::size_t place_count) {
  const Index* const place_of = place_faces.data()->data();  // by corner
  std::vector<Index> first(place_count, kNoIndex);
  for (auto c = static_cast<Index>(3 * place_faces.size()); c-- > 0;) first[place_of[c]] = c;
  std::size_t seen = 0;
  for (const Index start : first) {
    if (start == kNoIndex) return false;
    const std::size_t before = rings_.items.size();
    add_fan(
        corners, start, [](Index /*corner*/) {},
        [place_of](Index corner) { return place_of[corner]; });
    // An open ring has one neighbour more than faces.
    seen += rings_.items.size() - before - boundary_vertex_.back();
  }
  return seen == 3 * place_faces.size();
}

/// One vertex per fan, in the order of places, then of corners.
void TriangleMesh::split_places(const CornerTable& corners,
                                const std::vector<Triangle>& place_faces, std::size_t place_count) {
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
  faces_.assign(place_faces.size(), {kNoIndex, kNoIndex, kNoIndex});
  Index* const vertex_of = faces_.data()->data();  // by corner
  Index first = 0;
  for (Index p = 0; p < place_count; ++p) {
    std::size_t fans = 0;
    for (Index i = first; i < end[p]; ++i) {
      if (vertex_of[at_place[i]] != kNoIndex) continue;
      const auto vertex = static_cast<Index>(place_of_vertex_.size());
      add_fan(
          corners, at_place[i], [=](Index corner) { vertex_of[corner] = vertex; },
          [](Index corner) { return corner; });
      place_of_vertex_.push_back(p);
      ++fans;
    }
    counts_.split += fans > 1 ? fans - 1 : 0;
    first = end[p];
  }
  for (Index& item : rings_.items) item = vertex_of[item];
}

void TriangleMesh::make_vertices(const CornerTable& corners, std::vector<Triangle> place_faces,
                                 std::size_t place_count) {
  const auto begin = [&] {
    rings_.items.clear();
    rings_.items.reserve(3 * place_faces.size() + 3 * place_faces.size() / 16);
    rings_.offsets.assign(1, 0);
    rings_.offsets.reserve(place_count + 1);
    boundary_vertex_.clear();
  };
  begin();
  if (places_are_vertices(corners, place_faces, place_count)) {
    faces_ = std::move(place_faces);
    place_of_vertex_.resize(place_count);
    std::iota(place_of_vertex_.begin(), place_of_vertex_.end(), Index{0});
    return;
  }
  begin();
  split_places(corners, place_faces, place_count);
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
  mesh.make_vertices(corners, std::move(faces), weld.count);
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
