// Which strong edges are features: union-find by size that stops growing groups once they are large
// enough.

#include "core/strong_groups.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace fairway {
namespace {

constexpr std::int32_t kLarge = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kAlone = -1;
// Edges that are joined at a time.
constexpr std::size_t kBlock = 2048;

/// `count` ≤ 8 bytes as one number: bit 8 i + j is bit j of byte i.
std::uint64_t bits_at(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t bits = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&bits, bytes, sizeof bits);
    return bits & ~std::uint64_t{0} >> (64 - 8 * count);
  } else {
    for (std::size_t i = 0; i < count; ++i) bits |= std::uint64_t{bytes[i]} << 8 * i;
    return bits;
  }
}

}  // namespace

Index StrongGroups::root(Index slot) const {
  while (parent_[slot] >= 0) slot = static_cast<Index>(parent_[slot]);
  return slot;
}

/// Also shortens the way to a group that is large.
Index StrongGroups::root(Index slot) {
  const Index r = static_cast<const StrongGroups*>(this)->root(slot);
  if (parent_[r] == kLarge) parent_[slot] = kLarge;
  return r;
}

void StrongGroups::join(const StrongEdge& edge) {
  const Index a = root(edge.p);
  const Index b = root(edge.q);
  std::int32_t& at_a = parent_[a];
  std::int32_t& at_b = parent_[b];
  if (at_a == kLarge || at_b == kLarge || (a != b && at_a + at_b <= least_)) {
    at_a = at_b = kLarge;
  } else if (a != b) {
    const bool under_a = at_a < at_b;
    const std::int32_t sum = at_a + at_b;
    (under_a ? at_b : at_a) = static_cast<std::int32_t>(under_a ? a : b);
    (under_a ? at_a : at_b) = sum;
  }
}

/// Joins the first `count` edges of the block and keeps those whose groups are small so far.
void StrongGroups::join_block(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const StrongEdge& edge = block_[i];
    if (parent_[edge.p] == kLarge && parent_[edge.q] == kLarge) continue;
    join(edge);
    if (parent_[edge.p] != kLarge) noise_.push_back(edge);
  }
}

void StrongGroups::find(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                        int min_component) {
  least_ = -std::max(min_component, 2);
  parent_.assign(mesh.slot_count(), kAlone);
  noise_.clear();
  block_.resize(std::max(block_.size(), kBlock + 64));
  std::size_t count = 0;
  Index first_slot = 0;
  for (const Slice& slice : mesh.slices()) {
    for (Index k = 0; k < slice.valence; k += 8) {
      const std::size_t column = std::size_t{slice.columns} + k;
      const Index* ring = mesh.ring().data() + kLanes * column;
      const std::size_t columns = std::min<std::size_t>(8, slice.valence - k);
      std::uint64_t edges = bits_at(strong.data() + column, columns);
      if (edges != 0) edges &= bits_at(mesh.owned().data() + column, columns);
      for (; edges != 0; edges &= edges - 1) {
        const auto at = static_cast<Index>(std::countr_zero(edges));
        block_[count++] = {first_slot + at % kLanes, ring[at], k + at / kLanes};
      }
      if (count < kBlock) continue;
      join_block(count);
      count = 0;
    }
    first_slot += kLanes;
  }
  join_block(count);
  std::erase_if(noise_, [this](const StrongEdge& e) { return parent_[root(e.p)] == kLarge; });
}

std::vector<std::uint8_t> StrongGroups::features() const {
  std::vector<std::uint8_t> out(parent_.size() / kLanes);
  features(out);
  return out;
}

void StrongGroups::features(std::vector<std::uint8_t>& out) const {
  for (std::size_t slice = 0; slice < out.size(); ++slice) {
    const std::int32_t* parents = parent_.data() + kLanes * slice;
    unsigned met = 0;
    for (Index lane = 0; lane < kLanes; ++lane) {
      met |= (parents[lane] != kAlone ? 1U : 0U) << lane;
    }
    unsigned lanes = 0;
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<Index>(std::countr_zero(met));
      const Index r = root(static_cast<Index>(kLanes * slice) + lane);
      lanes |= (parent_[r] == kLarge ? 1U : 0U) << lane;
    }
    out[slice] = static_cast<std::uint8_t>(lanes);
  }
}

}  // namespace fairway
