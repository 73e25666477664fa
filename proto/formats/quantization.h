#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// Least and greatest values per component, as floats.
struct ValueBounds {
  std::vector<float> low, high;
  bool finite = true;  ///< there are values, and all of them are finite
  bool flags = true;   ///< all of them are 0 or 1
};

ValueBounds value_bounds(std::span<const Vec3> vectors);
ValueBounds value_bounds(std::span<const float> values, int components);
ValueBounds value_bounds(std::span<const double> values, int components);

/// The values that a Draco reader gets: origin + k · range / (2^bits − 1), k = 0 … 2^bits − 1.
/// Whatever is rounded to one grid stays equal where it was equal.
struct QuantizationGrid {
  int bits = 0;
  std::vector<float> origin;  ///< per component
  float range = 1.0F;         ///< of all components
  double error = 0.0;         ///< the most a value is off by, rounding of floats included

  /// Distance of neighbouring values.
  double step() const;
  /// What `value` is read back as, in the arithmetic of Draco.
  float rounded(float value, std::size_t component) const;
};

/// The grid of `bits` over the bounds; of one bit and exact where all values are 0 or 1. Nothing
/// where values have to stay floats: for 0 bits, where some are not finite, and where their range
/// is too large or too small for single precision.
std::optional<QuantizationGrid> make_grid(const ValueBounds& bounds, int bits);

/// "POSITION is off by at most 0.0005 (steps of 0.001, 14 bits)", or that it is exact.
std::string describe_grid(std::string_view name, const std::optional<QuantizationGrid>& grid);

}  // namespace fairway
