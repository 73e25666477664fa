#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/bytes.h"
#include "proto/formats/packed_values.h"
#include "proto/messages/format.h"

namespace fairway {

/// A mesh that has no glTF yet: one mesh, node and scene will be made around it.
struct FreshMesh {
  struct Attribute {
    std::string name;
    PackedValues values;
  };
  std::vector<Triangle> triangles;
  std::vector<Attribute> attributes;  ///< POSITION first
};

/// Writes a new document as GLB or self-contained glTF. Errors: too_large, internal.
Result<std::vector<std::byte>> write_fresh_gltf(const FreshMesh& mesh, Format format);

}  // namespace fairway
