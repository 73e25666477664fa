#pragma once

#include <vector>

#include "core/result.h"
#include "proto/formats/gltf_surfaces.h"
#include "proto/formats/gltf_tables.h"
#include "proto/formats/vertex_extras.h"

namespace fairway {

/// What COLOR_0 and TEXCOORD_0 of a surface hold, where all its primitives have them, alike, and no
/// vertex has two.
ExtraKinds gltf_extra_kinds(const GltfTables& tables, const SurfacePlan& plan);

/// Their values. Errors: invalid_mesh, unsupported_feature (also compressed in a way that is not
/// known; see make_colors(), too), too_large.
Result<ColorValues> read_gltf_colors(const GltfTables& tables, const GltfLayout& layout,
                                     const SurfacePlan& plan);
Result<std::vector<float>> read_gltf_texture_coordinates(const GltfTables& tables,
                                                         const GltfLayout& layout,
                                                         const SurfacePlan& plan);

}  // namespace fairway
