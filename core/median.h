#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
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

/// The same for values ≥ 0, in place of many: single-precision values are first narrowed to those
/// that share the median's leading bits, in one pass. Reorders the values.
template <class Real>
Real median_of_positive(std::vector<Real>& values) {
  if constexpr (std::is_same_v<Real, float>) {
    // Bit patterns of positive floats are ordered like their values.
    constexpr unsigned kShift = 19;
    std::array<std::size_t, 1U << (32U - kShift)> counts{};
    const auto bin = [](float v) { return std::bit_cast<std::uint32_t>(v) >> kShift; };
    for (const float v : values) ++counts[bin(v)];
    const std::size_t middle = values.size() / 2;
    std::size_t before = 0;
    std::uint32_t wanted = 0;
    while (before + counts[wanted] <= middle) before += counts[wanted++];
    // An even number's lower middle may lie in another bin: then sort out the slow way.
    if (values.size() % 2 == 0 && before == middle) return median(values);
    std::vector<float> narrowed;
    narrowed.reserve(counts[wanted]);
    for (const float v : values) {
      if (bin(v) == wanted) narrowed.push_back(v);
    }
    const auto at = narrowed.begin() + static_cast<std::ptrdiff_t>(middle - before);
    std::nth_element(narrowed.begin(), at, narrowed.end());
    if (values.size() % 2 == 1) return *at;
    return (*at + *std::max_element(narrowed.begin(), at)) / 2;
  } else {
    return median(values);
  }
}

}  // namespace fairway
