#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <vector>

namespace fairway {

/// The median (the mean of the middle two of an even number), 0 of none. Reorders the values.
template <class Real>
Real median(std::vector<Real>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

/// Of the values ≥ 0; −1 stands for none.
template <class Real>
struct MedianAndLargest {
  Real median = 0;
  Real largest = -1;
};

/// The median and the largest of the values ≥ 0; negative ones are left out. Of many single-
/// precision values only those that share the leading bits of one of the two are looked at twice.
/// Reorders the values.
template <class Real>
MedianAndLargest<Real> median_and_largest(std::vector<Real>& values) {
  if constexpr (std::is_same_v<Real, float>) {
    // Bit patterns of positive floats are ordered like their values; negative ones come behind.
    constexpr unsigned kShift = 19;
    constexpr std::size_t kBins = 1U << (31U - kShift);
    std::array<std::size_t, 2 * kBins> counts{};
    const auto bin = [](float v) { return std::bit_cast<std::uint32_t>(v) >> kShift; };
    for (const float v : values) ++counts[bin(v)];
    const std::size_t count =
        std::accumulate(counts.begin(), counts.begin() + kBins, std::size_t{0});
    if (count == 0) return {};
    const std::size_t middle = count / 2;
    std::size_t before = 0;
    std::uint32_t wanted = 0;
    while (before + counts[wanted] <= middle) before += counts[wanted++];
    std::uint32_t last = kBins - 1;
    while (counts[last] == 0) --last;
    std::vector<float> narrowed;
    narrowed.reserve(counts[wanted]);
    float largest = 0.0F;
    float below = 0.0F;  // the largest of those before the median's
    for (const float v : values) {
      const std::uint32_t b = bin(v);
      if (b == wanted) narrowed.push_back(v);
      if (b == last) largest = std::max(largest, v);
      if (before == middle && b < wanted) below = std::max(below, v);
    }
    const auto at = narrowed.begin() + static_cast<std::ptrdiff_t>(middle - before);
    std::nth_element(narrowed.begin(), at, narrowed.end());
    if (count % 2 == 1) return {*at, largest};
    const float lower = before == middle ? below : *std::max_element(narrowed.begin(), at);
    return {(*at + lower) / 2, largest};
  } else {
    std::erase_if(values, [](Real v) { return v < 0; });
    if (values.empty()) return {};
    const Real largest = *std::max_element(values.begin(), values.end());
    return {median(values), largest};
  }
}

}  // namespace fairway
