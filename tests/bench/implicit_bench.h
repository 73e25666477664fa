#pragma once

#include "core/execution.h"
#include "core/triangle_mesh.h"
#include "tests/bench/report.h"

namespace fairway::bench {

/// One semi-implicit AMC step, matrix and all, beside the mere solution of the same systems by
/// Eigen's BiCGSTAB with a diagonal preconditioner, to the same true residual.
Times implicit_step(const TriangleMesh& mesh, double mean_edge, const Execution& execution,
                    int runs);

}  // namespace fairway::bench
