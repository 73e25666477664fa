#pragma once

#include <stop_token>

#include "core/denoise.h"

namespace fairway {

/// denoise() by the variational method. Errors: diverged, canceled.
Result<Denoised> run_variational(const TriangleMesh& surface, const FlowOptions& options,
                                 const FlowObserver& observer, const std::stop_token& stop,
                                 const Execution& execution);

/// find_noise() of a run with the default options.
NoiseFinding look_for_noise(const TriangleMesh& surface, const Execution& execution);

}  // namespace fairway
