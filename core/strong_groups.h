#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/flow_kernels.h"
#include "core/packed_mesh.h"

namespace fairway {

/// Groups of strong edges connected by vertices: small ones are noise, the others features.
/// Kept between steps for its memory.
class StrongGroups {
 public:
  /// `strong`: a bit per lane and column, with its padding. Groups with fewer than
  /// `min_component` vertices are noise.
  void find(const PackedMesh& mesh, std::span<const std::uint8_t> strong, int min_component);

  /// Strong edges of small groups, by slot.
  std::span<const StrongEdge> noise() const { return noise_; }

  /// Feature vertices after find(): a bit per lane, one byte per slice.
  std::vector<std::uint8_t> features() const;
  void features(std::vector<std::uint8_t>& out) const;

  /// Memory, bytes.
  std::size_t bytes() const {
    return parent_.capacity() * sizeof(std::int32_t) +
           (noise_.capacity() + block_.capacity()) * sizeof(StrongEdge);
  }

 private:
  Index root(Index slot);
  Index root(Index slot) const;
  void join(const StrongEdge& edge);
  void join_block(std::size_t count);

  std::int32_t least_ = 0;  // − vertices of the smallest feature
  // By slot: the next slot towards the root of its group; at a root − its vertices, or kLarge where
  // it is large enough, and who else is in it does not matter: so trees stay small.
  std::vector<std::int32_t> parent_;
  std::vector<StrongEdge> block_;
  std::vector<StrongEdge> noise_;
};

}  // namespace fairway
