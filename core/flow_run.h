#pragma once

#include <stop_token>

#include "core/denoise.h"

namespace fairway {

/// denoise() by one of the paper's flows, or by none of them. Errors: diverged, canceled.
Result<Denoised> run_flow(const TriangleMesh& surface, const FlowOptions& options,
                          const FlowObserver& observer, const std::stop_token& stop,
                          const Execution& execution);

}  // namespace fairway
