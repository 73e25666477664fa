// Which strong edges are features: union-find over the few slots that have one.

#include "core/strong_groups.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

namespace fairway {
namespace {

constexpr Index kLarge = kNoIndex - 1;

/// Calls visit(edge) for every strong edge, from its lower slot.
template <class Visit>
void for_each_strong_edge(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                          const Visit& visit) {
  Index first_slot = 0;
  for (const Slice& slice : mesh.slices()) {
    for (Index k = 0; k < slice.valence; ++k) {
      const Index* column = mesh.ring().data() + kLanes * (std::size_t{slice.columns} + k);
      for (unsigned lanes = strong[slice.columns + k]; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<Index>(std::countr_zero(lanes));
        const Index p = first_slot + lane;
        if (p < column[lane]) visit(StrongEdge{p, column[lane], k});
      }
    }
    first_slot += kLanes;
  }
}

}  // namespace

/// Lists a slot when it is first met.
void StrongGroups::meet(Index slot) {
  if (parent_[slot] != kNoIndex) return;
  parent_[slot] = slot;
  group_size_[slot] = 1;
  met_.push_back(slot);
}

/// The root of a slot's group, or kLarge.
Index StrongGroups::root(Index slot) {
  while (parent_[slot] != slot) {
    const Index above = parent_[slot];
    if (above == kLarge) return kLarge;
    parent_[slot] = parent_[above];
    if (parent_[slot] == kLarge) return kLarge;
    slot = parent_[slot];
  }
  return slot;
}

/// Joins two groups; false if they are one large group now. A group that is large enough grows no
/// further tree, so trees stay small.
bool StrongGroups::join(Index p, Index q, int min_component) {
  Index a = root(p);
  Index b = root(q);
  if (a == b) return a != kLarge;
  if (a == kLarge) std::swap(a, b);
  if (b != kLarge) {
    group_size_[b] += group_size_[a];
    if (group_size_[b] >= min_component) {
      parent_[b] = kLarge;
      b = kLarge;
    }
  }
  parent_[a] = b;
  return b != kLarge;
}

void StrongGroups::find(const PackedMesh& mesh, std::span<const std::uint8_t> strong,
                        int min_component) {
  parent_.resize(mesh.slot_count(), kNoIndex);
  group_size_.resize(mesh.slot_count());
  noise_.clear();
  features_.clear();
  met_.clear();
  for_each_strong_edge(mesh, strong, [&](const StrongEdge& edge) {
    meet(edge.p);
    meet(edge.q);
    if (min_component > 2 && join(edge.p, edge.q, min_component)) noise_.push_back(edge);
  });
  if (min_component <= 2) {
    features_ = met_;
  } else {
    const auto is_large = [this](Index slot) { return root(slot) == kLarge; };
    std::copy_if(met_.begin(), met_.end(), std::back_inserter(features_), is_large);
    std::erase_if(noise_, [&](const StrongEdge& edge) { return is_large(edge.p); });
  }
  // Only what was touched is cleaned up for the next step.
  for (const Index slot : met_) parent_[slot] = kNoIndex;
}

}  // namespace fairway
