// Source: Morton 1966 (the curve).

#include "core/morton_order.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace fairway {
namespace {

constexpr unsigned kAxisBits = 10;

/// Moves the ten low bits of x three places apart.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16U) & 0x030000FFU;
  x = (x | x << 8U) & 0x0300F00FU;
  x = (x | x << 4U) & 0x030C30C3U;
  return (x | x << 2U) & 0x09249249U;
}

struct Keyed {
  std::uint32_t key;
  Index item;
};

std::vector<Keyed> morton_codes(std::span<const Vec3> positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions) box.extend(p);
  const double size = box.sizes().maxCoeff();
  const double scale = size > 0.0 ? ((1U << kAxisBits) - 1) / size : 0.0;
  std::vector<Keyed> out(positions.size());
  for (Index i = 0; i < positions.size(); ++i) {
    const Vec3 cell = (positions[i] - box.min()) * scale;
    out[i] = {spread_bits(static_cast<std::uint32_t>(cell.x())) |
                  spread_bits(static_cast<std::uint32_t>(cell.y())) << 1U |
                  spread_bits(static_cast<std::uint32_t>(cell.z())) << 2U,
              i};
  }
  return out;
}

/// Stable radix sort of 30-bit keys.
void sort_by_key(std::vector<Keyed>& items) {
  constexpr unsigned kDigitBits = kAxisBits;
  std::vector<Keyed> other(items.size());
  for (unsigned shift = 0; shift < 3 * kAxisBits; shift += kDigitBits) {
    std::array<Index, 1U << kDigitBits> place{};
    const auto digit = [shift](std::uint32_t key) {
      return key >> shift & ((1U << kDigitBits) - 1);
    };
    for (const Keyed& item : items) ++place[digit(item.key)];
    Index sum = 0;
    for (Index& p : place) sum = std::exchange(p, sum) + sum;
    for (const Keyed& item : items) other[place[digit(item.key)]++] = item;
    items.swap(other);
  }
}

}  // namespace

std::vector<Index> morton_order(std::span<const Vec3> positions) {
  std::vector<Keyed> keyed = morton_codes(positions);
  sort_by_key(keyed);
  std::vector<Index> order(keyed.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(),
                 [](const Keyed& one) { return one.item; });
  return order;
}

}  // namespace fairway
