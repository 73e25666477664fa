#pragma once

#include "core/execution.h"
#include "core/triangle_mesh.h"
#include "tests/bench/report.h"

namespace fairway::bench {

/// One semi-implicit AMC step, from positions to displacements, beside putting the same entries
/// into an Eigen matrix and solving by its BiCGSTAB with a diagonal preconditioner, to the same
/// true residual.
Times implicit_step(const TriangleMesh& mesh, double mean_edge, const Execution& execution,
                    int runs);

}  // namespace fairway::bench
