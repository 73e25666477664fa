#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fairway {

/// Coordinates in units stay below this, so that the difference of any two fits 32 bits.
inline constexpr double kMostFixedPointUnits = 1e9;

/// One unit of a fixed-point coordinate, in L, for coordinates up to `largest` L: with room for
/// nearly as much again below kMostFixedPointUnits.
inline double fixed_point_unit(double largest) {
  return std::exp2(std::ceil(std::log2(std::max(largest, 1.0))) + 2.0 - 31.0);
}

/// The nearest whole number of units; what is in between goes away from 0. std::lround takes five
/// times as long.
inline std::int32_t nearest_unit(double units) {
  return static_cast<std::int32_t>(units + (units < 0.0 ? -0.5 : 0.5));
}

/// Fixed-point positions serve a surface if rounding moves nothing by 1e-4 L in ten steps: its
/// coordinates are at most so many L,
inline constexpr double kLargestFixedPoint = 4096.0;
/// and every face's height is at least so many units: its normal is known to about a tenth of a
/// degree then, and a face without area stays one instead of getting a normal from rounding.
inline constexpr double kLeastFixedPointHeight = 512.0;

}  // namespace fairway
