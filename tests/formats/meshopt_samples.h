#pragma once

#include <cstdint>
#include <vector>

#include "tests/formats/sample_glb.h"

namespace fairway::test {

/// Streams as meshoptimizer's encoder writes them.
Bytes meshopt_attributes(const Bytes& bytes, std::size_t stride);
Bytes meshopt_triangles(const std::vector<std::uint32_t>& indices);
Bytes meshopt_sequence(const std::vector<std::uint32_t>& indices);

/// cube_sample() with its two views compressed into BIN; the plain ones are in a second buffer
/// without data, behind one another. Both views state `extension`.
SampleGlb meshopt_cube(const char* extension = "EXT_meshopt_compression");

}  // namespace fairway::test
