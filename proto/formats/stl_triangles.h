#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// Binary STL: 80 bytes of any kind, a u32 count, 50 bytes per triangle.
inline constexpr std::size_t kStlHeaderBytes = 80;
inline constexpr std::size_t kStlTriangleBytes = 50;

/// Appends normal, three corners (floats) and the attribute bytes. The normal belongs to the
/// corners as they are stored and is zero where they have no area.
void append_stl_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::uint16_t attribute,
                         std::vector<std::byte>& out);

}  // namespace fairway
