#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/packed_mesh.h"

namespace fairway {

/// A strong edge between slots p < q; q is neighbour k of p.
struct StrongEdge {
  Index p, q, k;
};

/// Groups of strong edges connected by vertices: small ones are noise, the others features.
/// Kept between steps for its memory.
class StrongGroups {
 public:
  /// `strong`: a bit per lane and column. Groups with fewer than `min_component` vertices are
  /// noise.
  void find(const PackedMesh& mesh, std::span<const std::uint8_t> strong, int min_component);

  const std::vector<StrongEdge>& noise() const { return noise_; }
  /// Slots of feature vertices, each once.
  const std::vector<Index>& features() const { return features_; }

  /// Memory per slot, bytes; the lists are short.
  std::size_t bytes() const {
    return parent_.size() * sizeof(Index) + group_size_.size() * sizeof(int);
  }

 private:
  void meet(Index slot);
  Index root(Index slot);
  bool join(Index p, Index q, int min_component);

  std::vector<StrongEdge> noise_;
  std::vector<Index> met_, features_;
  // By slot: the next slot towards the root of its group; kNoIndex: at no strong edge; kLarge: its
  // group is large enough, and who else is in it does not matter.
  std::vector<Index> parent_;
  std::vector<int> group_size_;  // by root
};

}  // namespace fairway
