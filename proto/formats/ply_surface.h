#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "proto/formats/document.h"
#include "proto/formats/ply_header.h"

namespace fairway {

/// The properties that are a vertex's colour; the last one is not in every file.
inline constexpr std::array<std::string_view, 4> kPlyColors = {"red", "green", "blue", "alpha"};

/// What a PLY holds of a mesh, and where.
struct PlySurface {
  Surface surface;
  PlyHeader header;
  std::array<std::size_t, 3> position = {};               ///< properties of a vertex
  std::optional<std::array<std::size_t, 3>> normal = {};  ///< nx, ny, nz where all are real
  std::size_t vertices_begin = 0;                         ///< offsets in the body
  std::size_t vertices_end = 0;
};

/// Reads all elements; faces and tristrips become triangles. Errors: those of decode_ply().
Result<PlySurface> read_ply_surface(ByteSpan bytes);

}  // namespace fairway
