#pragma once

#include <string>
#include <vector>

#include "proto/formats/document.h"
#include "proto/formats/gltf_primitive.h"

namespace fairway {

/// A stretch of a surface's vertices: one POSITION accessor with one NORMAL accessor beside it.
struct VertexBlock {
  std::size_t position = 0;
  std::optional<std::size_t> normal;
  std::optional<std::size_t> draco_view;
  Index first = 0;
  Index count = 0;
};

/// A triangle primitive of a surface, and the block its vertices are in.
struct SurfacePrimitive {
  std::size_t index = 0;  ///< in "primitives" of the mesh
  TriangleSource source;
  std::size_t block = 0;
  std::size_t first_triangle = 0;  ///< in the surface
  std::size_t triangles = 0;
};

/// Where the parts of one Surface stand in the document.
struct SurfacePlan {
  std::size_t mesh = 0;  ///< in "meshes"
  std::vector<VertexBlock> blocks;
  std::vector<SurfacePrimitive> primitives;
};

/// Where all surfaces of a document come from.
struct GltfLayout {
  std::vector<SurfacePlan> plans;  ///< one per surface
  DracoMeshes draco_meshes;
};

/// All surfaces of a document.
struct GltfSurfaces {
  std::vector<Surface> surfaces;
  GltfLayout layout;
  std::vector<std::string> notes;
};

/// Gathers the triangle primitives of every mesh; decodes the compressed views it needs. Errors:
/// invalid_mesh, unsupported_feature, no_triangles, too_large (compressed data).
Result<GltfSurfaces> gather_surfaces(const JsonPlace& root, GltfTables& tables);

}  // namespace fairway
