// Which strong edges are features: union-find by size that stops growing groups once they are large
// enough.

#include "core/strong_groups.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace fairway {
namespace {

constexpr std::int32_t kLarge = -(1 << 30);  // two of them still fit
constexpr std::int32_t kAlone = -1;
// Edges that are visited at a time.
constexpr std::size_t kBlock = 1024;

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

/// Calls visit(p, at) for every strong edge of a slice that starts at `first_slot`: slot p, and the
/// index of its other end in the ring.
template <class Visit>
void for_strong_edges(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                      const Slice& slice, Index first_slot, const Visit& visit) {
  for (Index k = 0; k < slice.valence; k += 8) {
    const std::size_t column = std::size_t{slice.columns} + k;
    const std::size_t columns = std::min<std::size_t>(8, slice.valence - k);
    std::uint64_t edges = bits_at(strong.data() + column, columns);
    if (edges != 0) edges &= bits_at(mesh.owned().data() + column, columns);
    for (; edges != 0; edges &= edges - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(edges));
      visit(first_slot + bit % kLanes, kLanes * column + bit);
    }
  }
}

/// A block of StrongEdges being filled.
class EdgeBlock {
 public:
  EdgeBlock() : p_(kBlock + kMore), q_(p_.size()), left_(p_.size()), right_(p_.size()) {}

  /// `slice`: of slot p; `at`: index of the other end in the ring.
  void add(const PackedMesh& mesh, const Slice& slice, Index p, std::size_t at) {
    const std::size_t first = kLanes * std::size_t{slice.columns};
    const std::size_t all = kLanes * std::size_t{slice.valence};
    const std::size_t next = at + kLanes < first + all ? at + kLanes : at + kLanes - all;
    const std::size_t before = at >= first + kLanes ? at - kLanes : at + all - kLanes;
    p_[count_] = p;
    q_[count_] = mesh.ring()[at];
    left_[count_] = mesh.ring()[next];
    right_[count_] = mesh.ring()[before];
    ++count_;
  }
  bool is_full() const { return count_ >= kBlock; }
  template <class Visit>
  void hand_over(const Visit& visit) {
    if (count_ > 0) visit(StrongEdges{p_.data(), q_.data(), left_.data(), right_.data(), count_});
    count_ = 0;
  }

 private:
  static constexpr std::size_t kMore = kLanes;
  std::vector<Index> p_, q_, left_, right_;
  std::size_t count_ = 0;
};

}  // namespace

/// Most ways are short: some steps without a branch, which would be foretold wrongly.
Index StrongGroups::root(Index slot) const {
  for (int hop = 0; hop < 2; ++hop) {
    slot = parent_[slot] >= 0 ? static_cast<Index>(parent_[slot]) : slot;
  }
  while (parent_[slot] >= 0) slot = static_cast<Index>(parent_[slot]);
  return slot;
}

/// Without branches on what the groups are like: on noise they would be foretold wrongly.
void StrongGroups::join(Index p, Index q) {
  if (parent_[p] == kLarge && parent_[q] == kLarge) return;
  const Index a = root(p);
  const Index b = root(q);
  const std::int32_t at_a = parent_[a];
  const std::int32_t at_b = parent_[b];
  const bool same = a == b;
  const bool large = at_a == kLarge || at_b == kLarge || (!same && at_a + at_b <= least_);
  const bool under_a = at_a < at_b;
  const std::int32_t new_a = same ? at_a : under_a ? at_a + at_b : static_cast<std::int32_t>(b);
  const std::int32_t new_b = same ? at_b : under_a ? static_cast<std::int32_t>(a) : at_a + at_b;
  parent_[a] = large ? kLarge : new_a;
  parent_[b] = large ? kLarge : new_b;
  parent_[p] = large ? kLarge : parent_[p];
  parent_[q] = large ? kLarge : parent_[q];
}

/// The lanes of a slice that belong to large groups.
std::uint8_t StrongGroups::large_lanes(Index slice) const {
  const std::int32_t* parents = parent_.data() + kLanes * std::size_t{slice};
  bool met = false;
  for (Index lane = 0; lane < kLanes; ++lane) met |= parents[lane] != kAlone;
  if (!met) return 0;
  unsigned lanes = 0;
  for (Index lane = 0; lane < kLanes; ++lane) {
    lanes |= (parent_[root(kLanes * slice + lane)] == kLarge ? 1U : 0U) << lane;
  }
  return static_cast<std::uint8_t>(lanes);
}

void StrongGroups::find(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                        int min_component, std::vector<std::uint8_t>& features) {
  least_ = -std::max(min_component, 2);
  parent_.assign(mesh.slot_count(), kAlone);
  Index first_slot = 0;
  for (const Slice& slice : mesh.slices()) {
    for_strong_edges(mesh, strong, slice, first_slot,
                     [&](Index p, std::size_t at) { join(p, mesh.ring()[at]); });
    first_slot += kLanes;
  }
  features.resize(mesh.slices().size());
  for (std::size_t slice = 0; slice < features.size(); ++slice) {
    features[slice] = large_lanes(static_cast<Index>(slice));
  }
}

void for_feature_edges(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                       std::span<const std::uint8_t> features,
                       const std::function<void(const StrongEdges&)>& visit) {
  EdgeBlock block;
  for (std::size_t s = 0; s < features.size(); ++s) {
    if (features[s] == 0) continue;
    const Slice& slice = mesh.slices()[s];
    for_strong_edges(mesh, strong, slice, static_cast<Index>(kLanes * s),
                     [&](Index p, std::size_t at) {
                       // Both ends are in one group.
                       if ((features[s] >> p % kLanes & 1U) == 0) return;
                       block.add(mesh, slice, p, at);
                       if (block.is_full()) block.hand_over(visit);
                     });
  }
  block.hand_over(visit);
}

}  // namespace fairway
