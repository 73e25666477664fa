// Colours and texture coordinates between formats. Source: glTF 2.0 sections 3.7.2.1 (linear
// colours) and 3.8.2 (the origin of an image is its upper left corner).

#include "proto/formats/vertex_extras.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fairway {
namespace {

constexpr double kMostByte = 255.0;
constexpr double kMostShort = 65535.0;

/// Rounding on the way, not another range.
constexpr double kSlack = 1e-3;

bool is_alpha(std::size_t i, int components) {
  return components == 4 && i % 4 == 3;
}

/// The linear values of the bytes over 255: most colours are bytes, and powers are slow.
std::array<double, 256> linear_bytes() {
  std::array<double, 256> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = linear_of_srgb(static_cast<double>(i) / kMostByte);
  }
  return out;
}

}  // namespace

Result<ColorValues> make_colors(std::span<const double> values, int components) {
  ColorValues out{components, {}};
  out.values.reserve(values.size());
  for (const double value : values) {
    if (value < -kSlack || value > 1.0 + kSlack) {
      return Error{ErrorCode::unsupported_feature,
                   "The colours are not between 0 and 1; scale them first."};
    }
    out.values.push_back(std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0))
                                              : 0.0F);
  }
  return out;
}

Result<ColorValues> make_colors_from_linear(std::vector<double> values, int components) {
  // Normalised bytes and shorts come to few values, and powers are slow: each is worked out once.
  std::vector<double> known(static_cast<std::size_t>(kMostShort) + 1, -1.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    double& value = values[i];
    if (is_alpha(i, components)) continue;
    const double stored = std::round(value * kMostShort);
    if (!(stored >= 0.0 && stored <= kMostShort && value == stored / kMostShort)) {
      value = srgb_of_linear(value);
      continue;
    }
    double& srgb = known[static_cast<std::size_t>(stored)];
    if (srgb < 0.0) srgb = srgb_of_linear(value);
    value = srgb;
  }
  return make_colors(values, components);
}

ColorValues make_colors(std::span<const Srgb> colors) {
  ColorValues out{3, {}};
  out.values.reserve(3 * colors.size());
  for (const Srgb& color : colors) {
    for (const std::uint8_t channel : color) {
      out.values.push_back(static_cast<float>(channel / kMostByte));
    }
  }
  return out;
}

std::vector<float> make_texture_coordinates(std::span<const double> values) {
  std::vector<float> out;
  out.reserve(values.size());
  for (const double value : values) {
    const auto stored = static_cast<float>(value);
    out.push_back(std::isfinite(stored) ? stored : 0.0F);
  }
  return out;
}

std::vector<float> make_texture_coordinates_from_top(std::vector<double> values) {
  for (std::size_t i = 1; i < values.size(); i += 2) values[i] = 1.0 - values[i];
  return make_texture_coordinates(values);
}

std::uint8_t color_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(static_cast<double>(value) * kMostByte));
}

PackedValues pack_linear_colors(const ColorValues& colors) {
  const std::array<double, 256> bytes = linear_bytes();
  std::vector<double> stored;
  stored.reserve(colors.values.size());
  for (std::size_t i = 0; i < colors.values.size(); ++i) {
    const float value = colors.values[i];
    const std::uint8_t byte = color_byte(value);
    double linear = static_cast<double>(value);
    if (!is_alpha(i, colors.components)) {
      const bool whole = value == static_cast<float>(byte / kMostByte);
      linear = whole ? bytes[byte] : linear_of_srgb(linear);
    }
    stored.push_back(std::round(linear * kMostShort));
  }
  return pack_values(stored, {ComponentType::u16, true, colors.components});
}

PackedValues pack_srgb_colors(const ColorValues& colors) {
  std::vector<double> stored;
  stored.reserve(colors.values.size());
  for (const float value : colors.values) stored.push_back(color_byte(value));
  return pack_values(stored, {ComponentType::u8, true, colors.components});
}

PackedValues pack_texture_coordinates_from_top(std::span<const float> values) {
  std::vector<float> stored(values.begin(), values.end());
  for (std::size_t i = 1; i < stored.size(); i += 2) {
    stored[i] = static_cast<float>(1.0 - static_cast<double>(stored[i]));
  }
  return pack_floats(stored, 2);
}

}  // namespace fairway
