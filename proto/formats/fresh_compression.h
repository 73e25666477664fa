#pragma once

#include <string_view>

#include "core/result.h"
#include "proto/formats/document.h"
#include "proto/formats/fresh_gltf.h"
#include "proto/messages/encoding.h"

namespace fairway {

/// A new glTF of a mesh, as write_fresh_gltf(), whose primitive is compressed as `encoding` says:
/// with KHR_draco_mesh_compression (positions, normals, floating texture coordinates and curvature
/// are rounded, all else is kept as it is; the note states the errors) or, lossless, with
/// EXT_meshopt_compression. `keep` has nothing to keep and is `none`. `name` is the surface's, for
/// the note. Errors: those of encode_draco(), too_large, internal.
Result<Encoded> write_fresh_gltf(const FreshMesh& mesh, Format format, const Encoding& encoding,
                                 std::string_view name);

}  // namespace fairway
