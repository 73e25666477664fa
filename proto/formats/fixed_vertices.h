#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "proto/formats/document.h"
#include "proto/messages/parameters.h"

namespace fairway {

/// What a client's fixed vertices are in a file: a list per surface, ascending, each vertex once.
/// Error: invalid_parameters with the pointer of the culprit, for a mesh or primitive that has no
/// triangles, an index beyond its vertices, and a list without a place where the file has more than
/// one POSITION accessor.
Result<std::vector<std::vector<Index>>> find_fixed_vertices(std::span<const Surface> surfaces,
                                                            std::span<const FixedVertices> fixed);

}  // namespace fairway
