// Vertices, faces and edges put in order along a Morton curve, and what is beside each.

#include "core/edge_stencils.h"

#include <algorithm>
#include <numeric>

#include "core/morton_order.h"
#include "core/surface_geometry.h"

namespace fairway {
namespace {

/// The place of each item when they are sorted by their keys below `bound`, stably.
std::vector<Index> places_by(std::span<const Index> keys, std::size_t bound) {
  std::vector<Index> next(bound + 1, 0);
  for (const Index key : keys) ++next[key + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Index> places;
  places.reserve(keys.size());
  for (const Index key : keys) places.push_back(next[key]++);
  return places;
}

/// Puts `value` into the first free entry; one that is full of others stays as it is.
void note(std::array<Index, 3>& entries, Index value) {
  const auto free = std::find(entries.begin(), entries.end(), kNoIndex);
  if (free != entries.end()) *free = value;
}

constexpr std::array<Index, 3> kNone = {kNoIndex, kNoIndex, kNoIndex};

}  // namespace

EdgeStencils::EdgeStencils(const TriangleMesh& mesh)
    : vertex_of_slot_(morton_order(mesh.positions())) {
  slot_of_vertex_.resize(vertex_of_slot_.size());
  for (Index slot = 0; slot < vertex_of_slot_.size(); ++slot) {
    slot_of_vertex_[vertex_of_slot_[slot]] = slot;
  }
  order_edges(mesh, order_faces(mesh));
  neighbours_of_face_.resize(faces_.size());
  for (Index f = 0; f < faces_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index s = stencils_of_face_[f][k];
      neighbours_of_face_[f][k] =
          s == kNoIndex ? f : stencils_[s].faces[stencils_[s].faces[0] == f ? 1 : 0];
    }
  }
  make_rings(mesh);
}

/// Returns the number each face of the mesh has here.
std::vector<Index> EdgeStencils::order_faces(const TriangleMesh& mesh) {
  std::vector<Index> least;
  least.reserve(mesh.faces().size());
  for (const Triangle& f : mesh.faces()) {
    least.push_back(
        std::min({slot_of_vertex_[f[0]], slot_of_vertex_[f[1]], slot_of_vertex_[f[2]]}));
  }
  std::vector<Index> numbers = places_by(least, slot_count());
  faces_.resize(numbers.size());
  for (std::size_t f = 0; f < numbers.size(); ++f) {
    const Triangle& face = mesh.faces()[f];
    faces_[numbers[f]] = {slot_of_vertex_[face[0]], slot_of_vertex_[face[1]],
                          slot_of_vertex_[face[2]]};
  }
  return numbers;
}

void EdgeStencils::order_edges(const TriangleMesh& mesh, std::span<const Index> face_numbers) {
  const FaceGeometry geometry =
      face_geometry(mesh, mesh.positions(), smallest_area(mesh.mean_edge_length()));
  const std::vector<Edge>& source = mesh.edges();
  std::vector<Index> least;
  least.reserve(source.size());
  for (const Edge& e : source) {
    least.push_back(std::min(slot_of_vertex_[e.p], slot_of_vertex_[e.q]));
  }
  const std::vector<Index> places = places_by(least, slot_count());
  std::vector<Index> order(source.size());
  for (Index e = 0; e < source.size(); ++e) order[places[e]] = e;
  stencils_of_face_.assign(faces_.size(), kNone);
  std::vector<std::array<Index, 3>> edges_of_face(faces_.size(), kNone);
  edges_.reserve(source.size());
  stencils_.reserve(source.size());
  for (const Index from : order) {
    const Edge& e = source[from];
    const auto number = static_cast<Index>(edges_.size());
    edges_.push_back({slot_of_vertex_[e.p], slot_of_vertex_[e.q]});
    for (const Index f : {e.face0, e.face1}) {
      if (f != kNoIndex) note(edges_of_face[face_numbers[f]], number);
    }
    if (!e.interior() || !geometry.present(e.face0) || !geometry.present(e.face1)) continue;
    const std::array<Index, 2> beside = {face_numbers[e.face0], face_numbers[e.face1]};
    for (const Index f : beside) {
      note(stencils_of_face_[f], static_cast<Index>(stencils_.size()));
    }
    stencils_.push_back({{slot_of_vertex_[e.p], slot_of_vertex_[e.q], slot_of_vertex_[e.opposite0],
                          slot_of_vertex_[e.opposite1]},
                         beside,
                         number,
                         {}});
  }
  find_sides(edges_of_face);
}

void EdgeStencils::find_sides(const std::vector<std::array<Index, 3>>& edges_of_face) {
  const auto find = [&](Index face, Index a, Index b) {
    for (const Index e : edges_of_face[face]) {
      if (e == kNoIndex) continue;
      if (edges_[e] == std::array{a, b} || edges_[e] == std::array{b, a}) return e;
    }
    return kNoIndex;
  };
  for (EdgeStencil& s : stencils_) {
    const auto [p, q, o0, o1] = s.points;
    const auto [f0, f1] = s.faces;
    s.sides = {find(f0, p, o0), find(f0, q, o0), find(f1, p, o1), find(f1, q, o1)};
  }
}

void EdgeStencils::make_rings(const TriangleMesh& mesh) {
  rings_.offsets.assign(1, 0);
  rings_.offsets.reserve(slot_count() + 1);
  rings_.items.reserve(mesh.rings().items.size());
  for (const Index v : vertex_of_slot_) {
    for (const Index w : mesh.rings()[v]) rings_.items.push_back(slot_of_vertex_[w]);
    rings_.offsets.push_back(static_cast<Index>(rings_.items.size()));
    boundary_.push_back(mesh.boundary_vertex()[v]);
  }
}

}  // namespace fairway
