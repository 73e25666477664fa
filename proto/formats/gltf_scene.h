#pragma once

#include "core/result.h"
#include "proto/formats/json_fields.h"

namespace fairway {

/// Checks what a glTF says about itself and its scenes: asset version 2, scenes and nodes that
/// exist, a node graph that is a forest of bounded depth, finite transforms, references in range.
/// Errors: unsupported_format (another glTF version), invalid_mesh.
Result<void> check_scene(const JsonPlace& root);

/// Deepest node below a root.
inline constexpr int kMaxNodeDepth = 1024;

}  // namespace fairway
