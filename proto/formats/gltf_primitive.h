#pragma once

#include <map>
#include <optional>
#include <string>

#include "proto/formats/gltf_draco.h"
#include "proto/formats/gltf_tables.h"

namespace fairway {

/// How a primitive strings its vertices together; the numbers of glTF.
enum class PrimitiveMode { triangles = 4, strip = 5, fan = 6 };

/// A primitive that is made of triangles; every index is in range and every vertex attribute has
/// one element per vertex.
struct TriangleSource {
  PrimitiveMode mode = PrimitiveMode::triangles;
  AttributeAccessors attributes;
  std::optional<std::size_t> indices;
  std::optional<DracoUse> draco;

  std::size_t position() const { return attributes.find("POSITION")->second; }
  std::optional<std::size_t> attribute(std::string_view name) const;
};

/// Reads a primitive; nothing for points and lines. Errors: invalid_mesh.
Result<std::optional<TriangleSource>> read_primitive(const JsonPlace& primitive,
                                                     const GltfTables& tables);

/// Vertices of the primitive: of its accessors, or of its decoded Draco mesh, whose counts must
/// agree with them.
Result<Index> vertex_count(const JsonPlace& primitive, const TriangleSource& source,
                           const GltfTables& tables, const DracoMeshes& meshes);

/// Triangles that the primitive will have, before they are made.
std::uint64_t triangle_estimate(const TriangleSource& source, const GltfTables& tables,
                                const DracoMeshes& meshes);

/// The triangles, each index below `vertices`. Errors: invalid_mesh, unsupported_feature.
Result<std::vector<Triangle>> read_triangles(const JsonPlace& primitive,
                                             const TriangleSource& source, Index vertices,
                                             const GltfTables& tables, const DracoMeshes& meshes);

}  // namespace fairway
