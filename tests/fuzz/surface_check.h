#pragma once

#include <span>
#include <string>
#include <vector>

#include "proto/formats/document.h"
#include "proto/formats/fresh_mesh.h"

namespace fairway::test {

/// Length of the bounding box's diagonal; 0 for nothing.
double extent_of(std::span<const Vec3> positions);

/// True where fewer than a hundred steps of single precision span the extent, at its distance from
/// the origin: rounding alone may bring such a mesh to the reader's limit.
bool nearly_collapses(const IndexedMesh& mesh);

/// What of a surface contradicts itself; "" for what a reader may hand on.
std::string surface_defect(const Surface& surface);

/// What of a document's extras contradicts its facts; "" also where they cannot be read.
std::string extras_defect(const Document& document);

/// Whether extras that can be read of `source` are there in `written`, made from it by
/// `conversion`.
std::string lost_extras_defect(const Document& source, const Document& written,
                               const Conversion& conversion);

/// The surfaces as they should read after writing: positions and normals of the results.
std::vector<Surface> with_results(std::span<const Surface> surfaces,
                                  std::span<const SurfaceResult> results);

/// How much of a surface must come back. Each but `corners` includes the ones before it.
enum class Likeness {
  counts,   ///< surfaces, vertices and triangles (after a quantizing writer)
  floats,   ///< positions, as single precision holds them
  bits,     ///< positions and triangles, bit for bit
  corners,  ///< positions of the triangles' corners: STL numbers its vertices anew
};

/// "", or where `found` is unlike `expected`.
std::string same_surfaces_defect(std::span<const Surface> expected, std::span<const Surface> found,
                                 Likeness likeness);

}  // namespace fairway::test
