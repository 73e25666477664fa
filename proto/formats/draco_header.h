#pragma once

#include "core/result.h"
#include "proto/formats/bytes.h"

namespace fairway {

/// Looks at what a Draco file claims before the library believes it. Errors: unsupported_format (no
/// Draco, or newer than 2.2), malformed_input (cut inside the header), no_triangles (point cloud),
/// invalid_mesh (unknown geometry type, or more faces or points than so few bytes can describe).
Result<void> check_draco_header(ByteSpan bytes);

}  // namespace fairway
