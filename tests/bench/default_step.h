#pragma once

#include "core/packed_flow.h"

namespace fairway::bench {

/// τ of a default run.
inline constexpr double kStepSize = 0.1;

/// What denoise() does per step of a default run. Returns λ in mean edges.
double default_step(PackedFlow& flow);

}  // namespace fairway::bench
