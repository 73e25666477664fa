#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/draco_decoder.h"
#include "proto/formats/packed_values.h"
#include "proto/formats/vertex_extras.h"

namespace fairway {

/// Whether the attribute of a bare Draco file holds colours (three or four bytes, shorts or floats)
/// or texture coordinates (two numbers) of vertices.
bool holds_colors(const DracoAttribute& attribute);
bool holds_texture_coordinates(const DracoAttribute& attribute);

/// Their values. Errors: invalid_mesh, too_large, unsupported_feature (see make_colors()).
Result<ColorValues> draco_colors(const DracoMesh& mesh, const DracoAttribute& attribute);
Result<std::vector<float>> draco_texture_coordinates(const DracoMesh& mesh,
                                                     const DracoAttribute& attribute);

/// Hands out the names that the attributes of a bare Draco file get in glTF.
class GltfNames {
 public:
  /// "" for an attribute without a place there.
  std::string name(const DracoAttribute& attribute);

 private:
  int texture_coordinates_ = 0;
  int colors_ = 0;
  std::set<std::string, std::less<>> names_;
};

/// An attribute of a bare Draco file as one of a glTF, which means colours and texture coordinates
/// in another way. Errors: the same.
Result<PackedValues> pack_for_gltf(const DracoMesh& mesh, const DracoAttribute& attribute);

}  // namespace fairway
