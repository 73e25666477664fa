#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"

namespace fairway {

/// Most triangles of a mesh: their corners are counted with an Index.
inline constexpr std::size_t kMostTriangles = kNoIndex / 3;

/// Adds the triangles (0, k, k + 1) of a polygon. Errors: invalid_mesh (fewer than three corners),
/// too_large.
Result<void> add_fan(std::span<const Index> corners, std::vector<Triangle>& triangles);

/// Adds the triangles of strips, every other one turned around; a negative index begins a new
/// strip. Errors: invalid_mesh (an index that is not below `vertices`), too_large.
Result<void> add_strips(std::span<const std::int64_t> indices, std::size_t vertices,
                        std::vector<Triangle>& triangles);

/// invalid_mesh unless 0 ≤ index < vertices.
Result<Index> check_index(std::int64_t index, std::size_t vertices);

/// Whether positions lie so near to the origin, compared with their extent, that single precision
/// holds them without loss that matters (their largest coordinate is at most 16 extents).
bool fit_floats(std::span<const Vec3> positions);

/// Unit normal of a triangle, zero where it has no area.
Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace fairway
