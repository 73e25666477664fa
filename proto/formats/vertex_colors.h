#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "proto/formats/packed_values.h"

namespace fairway {

/// A colour in sRGB.
using Srgb = std::array<std::uint8_t, 3>;

/// The transfer function of sRGB and its inverse (IEC 61966-2-1); 0 … 1 on both sides.
double srgb_of_linear(double linear);
double linear_of_srgb(double srgb);

/// Colours to write to a surface: COLOR_0 of a glTF, red, green and blue of a PLY, COLOR of Draco.
struct VertexColors {
  std::vector<Srgb> values;  ///< one per vertex
  bool replace = false;      ///< also where the file has colours
};

/// The colour of `value` in a diverging map from −1 (blue) by 0 (light grey) to 1 (red), clipped.
/// CIE lightness falls evenly from 0 to both ends, so that equal steps look equal.
Srgb diverging_colour(double value);

/// The colours of values in a diverging map that runs from −limit to limit; `limit` > 0.
std::vector<Srgb> diverging_colours(std::span<const float> values, double limit);

/// The magnitude that 95 % of the values stay below or at; 1 where that is 0 or there are none.
double automatic_limit(std::span<const float> values);

/// As COLOR_0 of a glTF, which is linear: normalised 16-bit RGBA, opaque.
PackedValues pack_linear_colors(std::span<const Srgb> colors);

/// As they are: normalised 8-bit RGBA, opaque.
PackedValues pack_srgb_colors(std::span<const Srgb> colors);

}  // namespace fairway
