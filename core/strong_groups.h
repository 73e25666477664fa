#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/flow_kernels.h"
#include "core/packed_mesh.h"

namespace fairway {

/// Groups of strong edges connected by vertices: small ones are noise, the others features.
/// Kept between steps for its memory.
class StrongGroups {
 public:
  /// `strong`: a bit per lane and column, with its padding. Groups with fewer than `min_component`
  /// vertices are noise. Fills `features`: a bit per lane, one byte per slice.
  void find(const PackedMesh& mesh, std::span<const std::uint8_t> strong, int min_component,
            std::vector<std::uint8_t>& features);

  /// Memory, bytes.
  std::size_t bytes() const { return parent_.capacity() * sizeof(std::int32_t); }

 private:
  Index root(Index slot) const;
  void join(Index p, Index q);
  std::uint8_t large_lanes(Index slice) const;

  std::int32_t least_ = 0;  // − vertices of the smallest feature
  // By slot: the next slot towards the root of its group; at a root − its vertices, or kLarge where
  // it is large enough, and who else is in it does not matter: so trees stay small.
  std::vector<std::int32_t> parent_;
};

/// Calls visit(edges) for blocks of the strong edges between feature vertices, in order of slots.
void for_feature_edges(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                       std::span<const std::uint8_t> features,
                       const std::function<void(const StrongEdges&)>& visit);

}  // namespace fairway
