// The arithmetic of Draco's quantisation. Source: Draco bitstream specification, section
// "Quantization Attribute Transform"; the last bits are those of its reference implementation.

#include "proto/formats/quantization.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Collects bounds value by value.
class BoundsCollector {
 public:
  explicit BoundsCollector(int components) {
    const auto size = static_cast<std::size_t>(components);
    out_.low.assign(size, std::numeric_limits<float>::infinity());
    out_.high.assign(size, -std::numeric_limits<float>::infinity());
  }

  void add(float value) {
    out_.low[component_] = std::min(out_.low[component_], value);
    out_.high[component_] = std::max(out_.high[component_], value);
    out_.finite = out_.finite && std::isfinite(value);
    out_.flags = out_.flags && (value == 0.0F || value == 1.0F);
    if (++component_ == out_.low.size()) component_ = 0;
    any_ = true;
  }

  ValueBounds take() {
    out_.finite = out_.finite && any_;
    return std::move(out_);
  }

 private:
  ValueBounds out_;
  std::size_t component_ = 0;
  bool any_ = false;
};

float greatest_step(int bits) {
  return static_cast<float>((1U << static_cast<unsigned>(bits)) - 1U);
}

}  // namespace

ValueBounds value_bounds(std::span<const Vec3> vectors) {
  BoundsCollector bounds(3);
  for (const Vec3& vector : vectors) {
    for (int c = 0; c < 3; ++c) bounds.add(static_cast<float>(vector[c]));
  }
  return bounds.take();
}

ValueBounds value_bounds(std::span<const float> values, int components) {
  BoundsCollector bounds(components);
  for (const float value : values) bounds.add(value);
  return bounds.take();
}

ValueBounds value_bounds(std::span<const double> values, int components) {
  BoundsCollector bounds(components);
  for (const double value : values) bounds.add(static_cast<float>(value));
  return bounds.take();
}

double QuantizationGrid::step() const {
  return static_cast<double>(range) / static_cast<double>(greatest_step(bits));
}

float QuantizationGrid::rounded(float value, std::size_t component) const {
  const float inverse = greatest_step(bits) / range;
  const float delta = range / greatest_step(bits);
  const float k = std::floor((value - origin[component]) * inverse + 0.5F);
  return k * delta + origin[component];
}

std::optional<QuantizationGrid> make_grid(const ValueBounds& bounds, int bits) {
  if (!bounds.finite) return std::nullopt;
  if (bounds.flags) {
    return QuantizationGrid{1, std::vector<float>(bounds.low.size(), 0.0F), 1.0F, 0.0};
  }
  if (bits == 0) return std::nullopt;
  // Below this the reciprocal of a step overflows.
  constexpr float kLeastRange = 1e-28F;
  QuantizationGrid grid{bits, bounds.low, 0.0F, 0.0};
  double largest = 0.0;
  for (std::size_t c = 0; c < bounds.low.size(); ++c) {
    grid.range = std::max(grid.range, bounds.high[c] - bounds.low[c]);
    largest = std::max({largest, std::abs(static_cast<double>(bounds.low[c])),
                        std::abs(static_cast<double>(bounds.high[c]))});
  }
  if (grid.range == 0.0F) {
    grid.range = 1.0F;
    return grid;
  }
  if (!std::isfinite(grid.range) || grid.range < kLeastRange) return std::nullopt;
  // Draco computes in floats: differences, products and sums are each rounded.
  grid.error = grid.step() / 2.0 + std::ldexp(largest + 2.0 * static_cast<double>(grid.range), -23);
  return grid;
}

std::string describe_grid(std::string_view name, const std::optional<QuantizationGrid>& grid) {
  if (!grid || grid->error == 0.0) return fmt::format("{} is exact", name);
  return fmt::format("{} is off by at most {:.3g} (steps of {:.3g}, {} bits)", name, grid->error,
                     grid->step(), grid->bits);
}

}  // namespace fairway
