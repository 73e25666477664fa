#pragma once

#include <cstdint>
#include <string>

#include "core/flow_options.h"
#include "core/mesh.h"

namespace fairway::test {

/// A mesh as no modeller would make it, chosen by the seed: soups, needles and slivers of area 0,
/// fans, bow ties, books, Möbius strips, wheels of high valence, coordinates from 1e-15 to 1e15,
/// then defects over it: flipped, repeated and degenerate triangles, torn and isolated vertices.
struct RandomMesh {
  std::string kind;
  IndexedMesh mesh;
};
RandomMesh random_mesh(std::uint64_t seed);

/// Any method, integration, mass, measure, boundary, convention and guards, with few steps.
FlowOptions random_options(std::uint64_t seed);

/// "explicit PMC, full mass, …": what random_options() chose, for messages.
std::string describe(const FlowOptions& options);

}  // namespace fairway::test
