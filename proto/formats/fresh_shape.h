#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "proto/formats/document.h"
#include "proto/formats/vertex_extras.h"

namespace fairway {

/// What a new file holds of a surface, wherever it stands. Normals may be missing, and extras.
struct FreshParts {
  const std::vector<Vec3>& positions;
  const std::vector<Triangle>& triangles;
  const std::vector<Vec3>& normals;
  const std::vector<VertexAttribute>& attributes;
  const VertexExtras& extras;
};

/// The names of an attribute's components as properties of a PLY vertex: lower case without the
/// leading underscore ("_CURVATURE_K1": curvature_k1, "_FEATURE": feature), with _x, _y, _z behind
/// where there are three ("_CURVATURE_DIR1": curvature_dir1_x …).
std::vector<std::string> property_names(const VertexAttribute& attribute);

/// A new PLY (binary little-endian; colours as uchar, texture coordinates as s and t), OBJ (colours
/// behind the position, without alpha) or STL (binary; positions only).
std::vector<std::byte> write_fresh_shape(const FreshParts& parts, Format format);

}  // namespace fairway
