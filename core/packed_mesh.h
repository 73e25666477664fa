#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/slice.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// A surface laid out for the kernels: vertices in Morton order (neighbours in space are neighbours
/// in memory), sorted by valence in windows of 2048, in slices of eight of equal valence. Every
/// kernel gathers over rings and writes only its own slots: no atomics, the same bits at any
/// thread count. Slots without a vertex fill up slices; their rings are themselves, so they have
/// no area and never move.
class PackedMesh {
 public:
  static constexpr std::size_t kPadding = 8;

  explicit PackedMesh(const TriangleMesh& mesh);

  std::span<const Slice> slices() const { return slices_; }
  std::span<const Index> ring() const { return ring_; }
  /// Per column, a bit per lane whose slot is less than its neighbour's: each edge counts once.
  /// Followed by kPadding bytes, so that eight may be read at a time.
  std::span<const std::uint8_t> owned() const { return owned_; }
  std::size_t slot_count() const { return kLanes * slices_.size(); }
  std::size_t column_count() const { return ring_.size() / kLanes; }

  /// Surface vertex of a slot, kNoIndex for a filler.
  const std::vector<Index>& vertex_of_slot() const { return vertex_of_slot_; }
  const std::vector<Index>& slot_of_vertex() const { return slot_of_vertex_; }

 private:
  void fill_window(const TriangleMesh& mesh, std::span<Index> window);
  void make_slices(const TriangleMesh& mesh, std::span<const Index> equals);
  void fetch_ring(const TriangleMesh& mesh, std::size_t slot) const;
  void make_rings(const TriangleMesh& mesh);

  std::vector<Slice> slices_;
  std::vector<Index> ring_;
  std::vector<std::uint8_t> owned_;
  std::vector<Index> vertex_of_slot_;
  std::vector<Index> slot_of_vertex_;
};

}  // namespace fairway
