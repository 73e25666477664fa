#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"

namespace fairway::quality {

/// Kinds of noise, each with its strength in mean edges of the clean mesh:
///   n   Gaussian along the vertex normals
///   r   Gaussian, each vertex along a direction of its own
///   i   Gaussian along the normals of a fifth of the vertices
///   s   along the normals and alike for neighbours: n averaged once over the ring, as strong
///   d   a depth sensor's: along one line of sight, correlated along its scan lines and across
///   q   the same depth rounded to steps of twice the strength, with a quarter of d
///   o   d, and one vertex in a hundred off by ten times as much
/// For instance "n0.2".
std::span<const std::string_view> noise_kinds();

/// The mesh with such noise, rounded to single precision as files have it. Deterministic on every
/// platform. The kind must be one of the above.
std::vector<Vec3> with_noise(const IndexedMesh& clean, const std::string& noise,
                             std::uint64_t seed);

}  // namespace fairway::quality
