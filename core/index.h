#pragma once

#include <cstdint>

namespace fairway {

/// The one index type for vertices, faces and edges.
using Index = std::uint32_t;
inline constexpr Index kNoIndex = ~Index{0};

}  // namespace fairway
