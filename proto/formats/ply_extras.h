#pragma once

#include <cstddef>
#include <vector>

#include "proto/formats/bytes.h"
#include "proto/formats/ply_header.h"
#include "proto/formats/vertex_extras.h"

namespace fairway {

/// The properties of a PLY's vertices that hold extras; no properties where they have none.
struct PlyExtras {
  std::vector<std::size_t> colors;               ///< red, green, blue and where it is there alpha
  std::vector<std::size_t> texture_coordinates;  ///< s and t, u and v or texture_u and texture_v

  ExtraKinds kinds() const;
  std::size_t properties() const { return colors.size() + texture_coordinates.size(); }
};

/// Colours may be uchar, ushort, float or double, texture coordinates float or double.
PlyExtras find_ply_extras(const PlyElement& vertex);

/// The records of the vertices, which a reader has walked over once.
struct PlyRecords {
  const PlyElement& vertex;
  ByteSpan bytes;
  PlyEncoding encoding = PlyEncoding::ascii;
};

/// Error: unsupported_feature, see make_colors().
Result<ColorValues> read_ply_colors(const PlyRecords& records, const PlyExtras& extras);
Result<std::vector<float>> read_ply_texture_coordinates(const PlyRecords& records,
                                                        const PlyExtras& extras);

}  // namespace fairway
