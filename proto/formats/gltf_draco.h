#pragma once

#include <map>
#include <string>

#include "proto/formats/draco_decoder.h"
#include "proto/formats/gltf_tables.h"
#include "proto/formats/packed_values.h"

namespace fairway {

/// What KHR_draco_mesh_compression says of one primitive.
struct DracoUse {
  std::size_t view = 0;                                   ///< holds the compressed mesh
  std::map<std::string, std::uint64_t, std::less<>> ids;  ///< attribute name → Draco unique id
};

/// The accessor of each attribute of a primitive, by name.
using AttributeAccessors = std::map<std::string, std::size_t, std::less<>>;

/// The decoded meshes of a document, by the view they came from.
using DracoMeshes = std::map<std::size_t, DracoMesh>;

/// Reads the extension of a primitive, if it has it. Errors: invalid_mesh.
Result<std::optional<DracoUse>> read_draco_use(const JsonPlace& primitive,
                                               const GltfTables& tables);

/// Decodes the mesh of `use` once and keeps it in `meshes`. Every compressed attribute can be read
/// through its accessor of `accessors`. Broken data inside a glTF is invalid_mesh with the pointer
/// of the primitive.
Result<void> decode_draco_use(const JsonPlace& primitive, const DracoUse& use,
                              const AttributeAccessors& accessors, const GltfTables& tables,
                              DracoMeshes& meshes);

/// Values of an attribute that is meant to be read through `accessor`: normalized integers decoded.
Result<std::vector<double>> draco_values(const DracoMesh& mesh, const DracoAttribute& attribute,
                                         const GltfAccessor& accessor);

/// The same, stored as `accessor` states.
Result<PackedValues> pack_draco(const DracoMesh& mesh, const DracoAttribute& attribute,
                                const GltfAccessor& accessor);

}  // namespace fairway
