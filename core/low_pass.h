#pragma once

#include <span>
#include <vector>

#include "core/edge_stencils.h"
#include "core/stencil_system.h"
#include "core/thread_team.h"

namespace fairway {

/// A windowed sinc of the umbrella operator I − W with its pass band, in (0, 2).
struct LowPass {
  double pass_band = 0.0;
  std::vector<Vec4> x;  ///< per slot
};

/// `x` through low passes with bands from 0.1 to 0.8 in steps of √2 (Taubin, Zhang, Golub 1996, a
/// Hamming window of degree 20), all in one sweep. A boundary is a curve of its own; held slots
/// stay.
std::vector<LowPass> low_passes(const EdgeStencils& mesh, std::span<const unsigned char> held,
                                std::span<const Vec4> x, ThreadTeam& team);

}  // namespace fairway
