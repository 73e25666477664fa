// Equal positions by hashing; by sorting where somebody made the hash collide.

#include "core/weld.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>

namespace fairway {
namespace {

// A run of occupied slots this long does not happen by chance at half load.
constexpr std::size_t kLongestProbe = 64;

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value + 0.0);
}

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = bits(p.x()) * 0x9E3779B97F4A7C15U;
  h = (h ^ (h >> 32U) ^ bits(p.y())) * 0xC2B2AE3D27D4EB4FU;
  h = (h ^ (h >> 32U) ^ bits(p.z())) * 0x165667B19E3779F9U;
  return h ^ (h >> 32U);
}

/// Nothing where a probe gets too long.
std::optional<Weld> weld_by_hashing(std::span<const Vec3> positions) {
  const std::size_t size = std::bit_ceil(2 * positions.size() + kLongestProbe);
  std::vector<Index> first(size, kNoIndex);
  Weld weld;
  weld.place.resize(positions.size());
  Index count = 0;
  for (Index i = 0; i < positions.size(); ++i) {
    std::size_t slot = hash(positions[i]) & (size - 1);
    std::size_t probes = 0;
    while (first[slot] != kNoIndex && positions[first[slot]] != positions[i]) {
      if (++probes > kLongestProbe) return std::nullopt;
      slot = (slot + 1) & (size - 1);
    }
    if (first[slot] == kNoIndex) {
      first[slot] = i;
      weld.place[i] = count++;
    } else {
      weld.place[i] = weld.place[first[slot]];
    }
  }
  weld.count = count;
  return weld;
}

Weld weld_by_sorting(std::span<const Vec3> positions) {
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [positions](Index a, Index b) {
    for (int c = 0; c < 3; ++c) {
      if (positions[a][c] != positions[b][c]) return positions[a][c] < positions[b][c];
    }
    return a < b;
  });
  // The first of a run of equals has the smallest index: it is the first to appear.
  std::vector<Index> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  Weld weld;
  weld.place.resize(positions.size());
  Index count = 0;
  for (Index i = 0; i < positions.size(); ++i) {
    weld.place[i] = first[i] == i ? count++ : weld.place[first[i]];
  }
  weld.count = count;
  return weld;
}

}  // namespace

Weld weld_equal_positions(std::span<const Vec3> positions) {
  if (std::optional<Weld> weld = weld_by_hashing(positions)) return *std::move(weld);
  return weld_by_sorting(positions);
}

}  // namespace fairway
