#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/packed_values.h"
#include "proto/formats/vertex_colors.h"

namespace fairway {

/// Colours of vertices on their way between two formats, as PLY, OBJ and bare Draco files mean
/// them: sRGB from 0 to 1, alpha linear. Bytes over 255 come back as the same bytes.
struct ColorValues {
  int components = 0;         ///< 3, or 4 with alpha; 0 where there are none
  std::vector<float> values;  ///< `components` per vertex

  bool empty() const { return components == 0; }
};

/// What vertices carry beside position and normal, between a reader and the writer of a new file.
/// Texture coordinates are u and v of each vertex with v = 0 at the lower edge of the image, as
/// PLY, OBJ and bare Draco files have them; empty where there are none.
struct VertexExtras {
  ColorValues colors;
  std::vector<float> texture_coordinates;
};

/// Which extras all vertices of a file's only mesh have, as known without reading them.
struct ExtraKinds {
  int color_components = 0;
  bool texture_coordinates = false;
};

/// Colours of values in sRGB; what is not finite becomes 0. Error: unsupported_feature where a
/// value is beyond 0 … 1, which the formats with bytes have no place for.
Result<ColorValues> make_colors(std::span<const double> values, int components);
/// The same of linear values, as COLOR_0 of a glTF has them.
Result<ColorValues> make_colors_from_linear(std::vector<double> values, int components);
ColorValues make_colors(std::span<const Srgb> colors);

/// Texture coordinates as single precision; what is not finite there becomes 0.
std::vector<float> make_texture_coordinates(std::span<const double> values);
/// The same of a glTF, where v = 0 is the upper edge.
std::vector<float> make_texture_coordinates_from_top(std::vector<double> values);

/// The nearest byte of a value from 0 to 1.
std::uint8_t color_byte(float value);

/// As COLOR_0 of a glTF: linear, normalised 16 bits, which tell all bytes of sRGB apart.
PackedValues pack_linear_colors(const ColorValues& colors);
/// As COLOR of a bare Draco file: sRGB, normalised 8 bits.
PackedValues pack_srgb_colors(const ColorValues& colors);
/// As TEXCOORD_0 of a glTF.
PackedValues pack_texture_coordinates_from_top(std::span<const float> values);

}  // namespace fairway
