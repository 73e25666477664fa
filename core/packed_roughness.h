#pragma once

#include <span>

#include "core/packed_mesh.h"

namespace fairway {

/// median |h_p − mean of h over the neighbours| over median |h|, inner vertices only, of a field
/// `h` with one number per slot; 0 where h vanishes. See curvature_roughness().
double roughness_of(const PackedMesh& mesh, std::span<const double> h);

}  // namespace fairway
