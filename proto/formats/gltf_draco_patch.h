#pragma once

#include <vector>

#include "proto/formats/document.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/gltf_output.h"
#include "proto/formats/gltf_surfaces.h"

namespace fairway {

/// What a compressed primitive is made from. Everything outlives it.
struct DracoPatchSource {
  const GltfTables& tables;
  const DracoMeshes& draco;
  const SurfacePlan& plan;
  const Surface& surface;
  const SurfaceResult& result;
  const SurfaceGrids& grids;
  const DracoOptions& options;
  const std::vector<std::size_t>& references;  ///< how often each accessor is named
};

/// Makes a primitive one of KHR_draco_mesh_compression: positions, what moved with them, new
/// attributes, and what was compressed before go into a new stream and get accessors as labels;
/// other attributes stay as they are beside it, so that order is kept, unless the options let it
/// change and nothing in the document names the vertices. Errors: those of encode_draco() and of
/// reading the attributes.
Result<void> compress_primitive(const DracoPatchSource& source, const SurfacePrimitive& primitive,
                                GltfOutput& output);

}  // namespace fairway
