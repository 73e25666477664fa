#pragma once

#include "proto/formats/gltf_primitive.h"
#include "proto/formats/gltf_tables.h"

namespace fairway {

/// True for a buffer that stands only for the decompressed views.
bool is_fallback_buffer(const JsonPlace& buffer);

/// Reads EXT_meshopt_compression or KHR_meshopt_compression of a view, if it has one; its bytes lie
/// inside one of `buffers`. `view` is what the view itself states. Errors: invalid_mesh.
Result<std::optional<GltfCompression>> read_compression(const JsonPlace& place,
                                                        const GltfView& view,
                                                        const std::vector<GltfBuffer>& buffers);

/// Decodes the compressed views that the vertices, normals, tangents and indices of a primitive
/// stand in, each once. Plain bytes of a fallback buffer serve where the compression is unknown.
/// Errors: invalid_mesh, unsupported_feature, too_large (all views together).
Result<void> decode_views(const TriangleSource& source, GltfTables& tables);

/// The same of the views that one accessor stands in.
Result<void> decode_views_of(std::size_t accessor, GltfTables& tables);

}  // namespace fairway
