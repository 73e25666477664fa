#pragma once

#include <vector>

#include "core/flow_options.h"
#include "core/triangle_mesh.h"

namespace fairway::test {

/// An explicit flow by the plain operators: what the kernels must reproduce. `steps`, `step_size`
/// and, for the anisotropic methods, `lambda` or `feature_angle` must be given; `unfold` is not
/// done.
std::vector<Vec3> reference_flow(const TriangleMesh& mesh, const FlowOptions& options);

}  // namespace fairway::test
