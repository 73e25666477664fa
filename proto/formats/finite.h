#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace fairway {

// Whether all numbers are finite, without a branch: one more in an exponent of ones carries into
// the sign.

inline bool all_finite(std::span<const double> numbers) {
  std::uint64_t carried = 0;
  for (const double x : numbers) {
    carried |= (std::bit_cast<std::uint64_t>(x) & 0x7FF0'0000'0000'0000U) + 0x0010'0000'0000'0000U;
  }
  return carried >> 63U == 0;
}

/// The same once they are rounded to single precision.
inline bool all_finite_as_floats(std::span<const double> numbers) {
  std::uint32_t carried = 0;
  for (const double x : numbers) {
    carried |= (std::bit_cast<std::uint32_t>(static_cast<float>(x)) & 0x7F80'0000U) + 0x0080'0000U;
  }
  return carried >> 31U == 0;
}

}  // namespace fairway
