// The order in which the kernels see a surface.

#include "core/packed_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/morton_order.h"

namespace fairway {
namespace {

constexpr std::size_t kWindow = 2048;
/// Slots between the ring that is read and the one that is asked for.
constexpr std::size_t kAhead = 32;

std::uint64_t kind_of(const TriangleMesh& mesh, Index v) {
  return 2 * std::uint64_t{mesh.rings()[v].size()} + mesh.boundary_vertex()[v];
}

}  // namespace

PackedMesh::PackedMesh(const TriangleMesh& mesh) {
  std::vector<Index> order = morton_order(mesh.positions());
  slot_of_vertex_.resize(order.size());
  vertex_of_slot_.reserve(order.size() + order.size() / 16 + 64);
  for (std::size_t first = 0; first < order.size(); first += kWindow) {
    fill_window(mesh, std::span(order).subspan(first, std::min(kWindow, order.size() - first)));
  }
  make_rings(mesh);
}

/// Groups a window's vertices by valence and kind, each group in Morton order.
void PackedMesh::fill_window(const TriangleMesh& mesh, std::span<Index> window) {
  constexpr std::uint64_t kUsual = 64;  // kinds below valence 32 have a bucket of their own
  std::array<Index, kUsual + 2> end{};
  std::array<Index, kWindow> sorted;
  const auto bucket = [&mesh, kUsual](Index v) { return std::min(kind_of(mesh, v), kUsual); };
  for (const Index v : window) ++end[bucket(v) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::array<Index, kUsual + 2> place = end;
  for (const Index v : window) sorted[place[bucket(v)]++] = v;
  const std::span<Index> all = std::span(sorted).first(window.size());
  for (std::size_t kind = 0; kind < kUsual; ++kind) {
    make_slices(mesh, all.subspan(end[kind], end[kind + 1] - end[kind]));
  }
  std::span<Index> unusual = all.subspan(end[kUsual]);
  std::stable_sort(unusual.begin(), unusual.end(),
                   [&mesh](Index a, Index b) { return kind_of(mesh, a) < kind_of(mesh, b); });
  for (std::size_t i = 0; i < unusual.size();) {
    std::size_t last = i + 1;
    while (last < unusual.size() && kind_of(mesh, unusual[last]) == kind_of(mesh, unusual[i]))
      ++last;
    make_slices(mesh, unusual.subspan(i, last - i));
    i = last;
  }
}

void PackedMesh::make_slices(const TriangleMesh& mesh, std::span<const Index> equals) {
  for (std::size_t i = 0; i < equals.size(); i += kLanes) {
    const Slice* before = slices_.empty() ? nullptr : &slices_.back();
    const auto valence = static_cast<Index>(mesh.rings()[equals[i]].size());
    slices_.push_back({before == nullptr ? 0 : before->columns + before->valence, valence,
                       mesh.boundary_vertex()[equals[i]] != 0});
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Index v = i + lane < equals.size() ? equals[i + lane] : kNoIndex;
      if (v != kNoIndex) slot_of_vertex_[v] = static_cast<Index>(vertex_of_slot_.size());
      vertex_of_slot_.push_back(v);
    }
  }
}

/// Neighbouring slots lie rows apart in most files, so that no processor foresees their rings.
void PackedMesh::fetch_ring(const TriangleMesh& mesh, std::size_t slot) const {
  if (slot >= vertex_of_slot_.size() || vertex_of_slot_[slot] == kNoIndex) return;
  __builtin_prefetch(mesh.rings()[vertex_of_slot_[slot]].data());
}

void PackedMesh::make_rings(const TriangleMesh& mesh) {
  if (slices_.empty()) return;
  ring_.resize(kLanes * std::size_t{slices_.back().columns + slices_.back().valence});
  owned_.resize(column_count() + kPadding);
  for (std::size_t s = 0; s < slices_.size(); ++s) {
    std::uint8_t* owned = owned_.data() + slices_[s].columns;
    Index* column = ring_.data() + kLanes * std::size_t{slices_[s].columns};
    for (Index lane = 0; lane < kLanes; ++lane) {
      const auto slot = static_cast<Index>(kLanes * s + lane);
      const Index v = vertex_of_slot_[slot];
      fetch_ring(mesh, slot + kAhead);
      const Index* neighbours = v == kNoIndex ? nullptr : mesh.rings()[v].data();
      for (Index k = 0; k < slices_[s].valence; ++k) {
        const Index q = v == kNoIndex ? slot : slot_of_vertex_[neighbours[k]];
        column[kLanes * k + lane] = q;
        owned[k] = static_cast<std::uint8_t>(owned[k] | (slot < q ? 1U : 0U) << lane);
      }
    }
  }
}

}  // namespace fairway
