#pragma once

#include <string_view>

#include "core/result.h"
#include "proto/formats/json_fields.h"

namespace fairway {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";
inline constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";
inline constexpr const char* kNewerMeshoptExtension = "KHR_meshopt_compression";

/// Refuses a document that requires an extension which could change what its geometry is.
/// Errors: unsupported_feature, invalid_mesh (not lists of names).
Result<void> check_extensions(const JsonPlace& root);

/// True where `name` stands in extensionsUsed or extensionsRequired.
bool uses_extension(const JsonPlace& root, std::string_view name);

/// Puts `name` on both lists of extensions, where it is not there.
void require_extension(std::string_view name, Json& root);

}  // namespace fairway
