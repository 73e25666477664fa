#pragma once

#include <string_view>
#include <vector>

#include "proto/formats/document.h"

namespace fairway {

/// The corners of one face of an OBJ.
struct ObjCorner {
  Index vertex = 0;
  Index normal = kNoIndex;  ///< in the lines "vn"
};

/// What an OBJ holds of a mesh, and where. Words are views into the text.
struct ObjSurface {
  Surface surface;
  std::vector<std::string_view> position_words;  ///< three per "v"
  std::vector<std::string_view> normal_words;    ///< three per "vn"
  std::vector<Vec3> normals;                     ///< as they are; zero where they are no numbers
  std::vector<ObjCorner> corners;                ///< three per triangle
  std::size_t texture_coordinates = 0;           ///< lines "vt"
  std::vector<Index> texture_of_vertex;          ///< see TextureOfVertex
  std::size_t colors = 0;                        ///< lines "v" with three more numbers
  std::size_t materials = 0;                     ///< lines "usemtl"
  std::size_t groups = 0;                        ///< lines "g" and "o"
  std::size_t polygons = 0;                      ///< of more than three corners
};

/// Reads the lines v, vt (counted), vn and f. Errors: those of decode_obj().
Result<ObjSurface> read_obj_surface(std::string_view text);

}  // namespace fairway
