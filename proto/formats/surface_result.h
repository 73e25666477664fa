#pragma once

#include <span>

#include "core/result.h"
#include "proto/formats/document.h"

namespace fairway {

/// There must be one result per surface, each with values for all its vertices, and positions that
/// a float holds. Errors: internal, diverged.
Result<void> check_results(std::span<const Surface> surfaces,
                           std::span<const SurfaceResult> results);

}  // namespace fairway
