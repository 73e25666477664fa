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

/// Whether any of a slice's columns has a strong edge.
bool has_strong(const std::uint8_t* strong, Index valence) {
  if (valence > 8) {
    return std::any_of(strong, strong + valence, [](std::uint8_t lanes) { return lanes != 0; });
  }
  std::uint64_t all = 0;
  std::memcpy(&all, strong, sizeof all);
  const std::uint64_t wanted = std::endian::native == std::endian::little
                                   ? ~std::uint64_t{0} >> (64 - 8 * valence)
                                   : ~std::uint64_t{0} << (64 - 8 * valence);
  return (all & wanted) != 0;
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
  block_.resize(std::max(block_.size(), kBlock + kLanes));
  std::size_t count = 0;
  Index first_slot = 0;
  for (const Slice& slice : mesh.slices()) {
    const std::uint8_t* bits = strong.data() + slice.columns;
    if (has_strong(bits, slice.valence)) {
      for (Index k = 0; k < slice.valence; ++k) {
        if (bits[k] == 0) continue;
        const Index* column = mesh.ring().data() + kLanes * (std::size_t{slice.columns} + k);
        // Without a branch per lane, which would be foretold wrongly half the time.
        for (Index lane = 0; lane < kLanes; ++lane) {
          block_[count] = {first_slot + lane, column[lane], k};
          const bool counts = (bits[k] >> lane & 1U) != 0 && first_slot + lane < column[lane];
          count += counts ? 1 : 0;
        }
        if (count < kBlock) continue;
        join_block(count);
        count = 0;
      }
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
