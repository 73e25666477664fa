#pragma once

#include "core/flow_kernels.h"

namespace fairway {

/// How a flow is computed; none of it changes a result beyond rounding, threads not even that.
struct Execution {
  /// `automatic`: double for surfaces of up to 20 000 vertices, where it costs little, and for the
  /// isotropic mean curvature flow, which amplifies rounding; single otherwise.
  enum class Precision { automatic, single_precision, double_precision };

  Precision precision = Precision::automatic;
  Isa isa = best_isa();
  unsigned threads =
      1;  ///< at least 1; jobs run side by side first, so more pays for large meshes only
};

}  // namespace fairway
