// Numbers as colours. Sources: CIE 15 (L*a*b*, D65), IEC 61966-2-1 (sRGB).

#include "proto/formats/vertex_colors.h"

#include <algorithm>
#include <cmath>

namespace fairway {
namespace {

/// L*, a*, b*.
using Lab = std::array<double, 3>;

// Straight lines in L*a*b*, with equal lightness on both sides of the middle.
constexpr Lab kMiddle = {94.0, 0.0, 0.0};
constexpr Lab kLow = {34.0, 8.0, -44.0};
constexpr Lab kHigh = {34.0, 50.0, 32.0};

constexpr double kLimitShare = 0.95;

Srgb to_srgb(const Lab& lab) {
  const auto inverse = [](double t) {
    return t > 6.0 / 29.0 ? t * t * t : 3.0 * (6.0 / 29.0) * (6.0 / 29.0) * (t - 4.0 / 29.0);
  };
  const double l = (lab[0] + 16.0) / 116.0;
  const double x = 0.95047 * inverse(l + lab[1] / 500.0);
  const double y = inverse(l);
  const double z = 1.08883 * inverse(l - lab[2] / 200.0);
  const std::array<double, 3> linear = {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                                        -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                                        0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
  Srgb out{};
  for (std::size_t c = 0; c < 3; ++c) {
    out[c] = static_cast<std::uint8_t>(
        std::lround(255.0 * srgb_of_linear(std::clamp(linear[c], 0.0, 1.0))));
  }
  return out;
}

PackedValues pack(std::span<const Srgb> colors, ComponentType type,
                  const std::array<double, 256>& stored, double opaque) {
  std::vector<double> values;
  values.reserve(4 * colors.size());
  for (const Srgb& color : colors) {
    for (const std::uint8_t channel : color) values.push_back(stored[channel]);
    values.push_back(opaque);
  }
  return pack_values(values, {type, true, 4});
}

}  // namespace

double srgb_of_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double linear_of_srgb(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

Srgb diverging_colour(double value) {
  const double t = std::min(std::abs(value), 1.0);
  const Lab& end = value < 0.0 ? kLow : kHigh;
  Lab lab{};
  for (std::size_t c = 0; c < 3; ++c) lab[c] = kMiddle[c] + t * (end[c] - kMiddle[c]);
  return to_srgb(lab);
}

std::vector<Srgb> diverging_colours(std::span<const float> values, double limit) {
  // Finer than 8 bits tell apart.
  constexpr int kSteps = 512;
  std::array<Srgb, 2 * kSteps + 1> table{};
  for (int i = -kSteps; i <= kSteps; ++i) {
    table[static_cast<std::size_t>(i + kSteps)] = diverging_colour(static_cast<double>(i) / kSteps);
  }
  std::vector<Srgb> out;
  out.reserve(values.size());
  for (const float value : values) {
    const double at = std::clamp(static_cast<double>(value) / limit, -1.0, 1.0);
    out.push_back(table[static_cast<std::size_t>(std::lround(at * kSteps) + kSteps)]);
  }
  return out;
}

double automatic_limit(std::span<const float> values) {
  if (values.empty()) return 1.0;
  std::vector<float> magnitudes;
  magnitudes.reserve(values.size());
  for (const float value : values) magnitudes.push_back(std::abs(value));
  const auto rank = static_cast<std::ptrdiff_t>(
      std::ceil(kLimitShare * static_cast<double>(values.size())) - 1.0);
  std::nth_element(magnitudes.begin(), magnitudes.begin() + rank, magnitudes.end());
  const double limit = static_cast<double>(magnitudes[static_cast<std::size_t>(rank)]);
  return limit > 0.0 && std::isfinite(limit) ? limit : 1.0;
}

PackedValues pack_linear_colors(std::span<const Srgb> colors) {
  constexpr double kOne = 65535.0;
  std::array<double, 256> stored{};
  for (std::size_t i = 0; i < stored.size(); ++i) {
    stored[i] = std::round(kOne * linear_of_srgb(static_cast<double>(i) / 255.0));
  }
  return pack(colors, ComponentType::u16, stored, kOne);
}

PackedValues pack_srgb_colors(std::span<const Srgb> colors) {
  std::array<double, 256> stored{};
  for (std::size_t i = 0; i < stored.size(); ++i) stored[i] = static_cast<double>(i);
  return pack(colors, ComponentType::u8, stored, 255.0);
}

}  // namespace fairway
