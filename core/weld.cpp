// Equal positions by hashing; by sorting where somebody made the hash collide.

#include "core/weld.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

namespace fairway {
namespace {

// A run of occupied slots this long does not happen by chance at half load.
constexpr std::size_t kLongestProbe = 64;
// Positions per part: the table of one stays in the second-level cache, however many there are.
constexpr std::size_t kPart = 8192;

/// A position as the tables keep it: what is unlike in the hash need not be looked up.
struct Hashed {
  std::uint32_t hash;
  Index item;
};

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value + 0.0);
}

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = bits(p.x()) * 0x9E3779B97F4A7C15U;
  h = (h ^ (h >> 32U) ^ bits(p.y())) * 0xC2B2AE3D27D4EB4FU;
  h = (h ^ (h >> 32U) ^ bits(p.z())) * 0x165667B19E3779F9U;
  return h ^ (h >> 32U);
}

/// All positions, parted by the high bits of their hashes, ascending in each part.
struct Parts {
  std::vector<Hashed> items;
  std::vector<std::size_t> end;  ///< of each part

  explicit Parts(std::span<const Vec3> positions) : items(positions.size()) {
    const std::size_t count = std::bit_ceil(positions.size() / kPart + 1);
    end.resize(count);
    const auto part = [mask = count - 1](std::uint64_t h) { return h >> 32U & mask; };
    for (const Vec3& p : positions) ++end[part(hash(p))];
    std::size_t sum = 0;
    for (std::size_t& e : end) sum = std::exchange(e, sum) + sum;
    for (Index i = 0; i < positions.size(); ++i) {
      const std::uint64_t h = hash(positions[i]);
      items[end[part(h)]++] = {static_cast<std::uint32_t>(h), i};
    }
  }
};

/// Writes the first item at the position of each into `first`. False where a probe gets too long.
bool find_firsts(std::span<const Vec3> positions, std::span<const Hashed> part,
                 std::vector<Hashed>& table, std::vector<Index>& first) {
  const std::size_t mask = std::bit_ceil(2 * part.size() + kLongestProbe) - 1;
  table.assign(mask + 1, {0, kNoIndex});
  for (const Hashed& one : part) {
    std::size_t slot = one.hash & mask;
    std::size_t probes = 0;
    while (table[slot].item != kNoIndex &&
           (table[slot].hash != one.hash || positions[table[slot].item] != positions[one.item])) {
      if (++probes > kLongestProbe) return false;
      slot = (slot + 1) & mask;
    }
    if (table[slot].item == kNoIndex) table[slot] = one;
    first[one.item] = table[slot].item;
  }
  return true;
}

/// Numbers the classes: `place` holds the first item of each item's class.
Weld number(std::vector<Index> place) {
  Index count = 0;
  for (Index i = 0; i < place.size(); ++i) {
    place[i] = place[i] == i ? count++ : place[place[i]];
  }
  return {std::move(place), count};
}

/// Nothing where a probe gets too long.
std::optional<Weld> weld_by_hashing(std::span<const Vec3> positions) {
  const Parts parts(positions);
  std::vector<Index> first(positions.size());
  std::vector<Hashed> table;
  std::size_t begin = 0;
  for (const std::size_t end : parts.end) {
    const auto part = std::span(parts.items).subspan(begin, end - begin);
    if (!find_firsts(positions, part, table, first)) return std::nullopt;
    begin = end;
  }
  return number(std::move(first));
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
  return number(std::move(first));
}

}  // namespace

Weld weld_equal_positions(std::span<const Vec3> positions) {
  if (std::optional<Weld> weld = weld_by_hashing(positions)) return *std::move(weld);
  return weld_by_sorting(positions);
}

}  // namespace fairway
