#pragma once

#include <string>

namespace fairway::test {

/// What is wrong with a small_glb().
enum class Flaw { none, truncated, index_out_of_range, not_a_number };

/// A tetrahedron as GLB, written byte by byte.
std::string small_glb(Flaw flaw = Flaw::none);

/// A noisy torus of 2 · size² vertices, from `fairway sample`.
std::string noisy_torus(int size);

}  // namespace fairway::test
