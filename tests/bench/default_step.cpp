#include "tests/bench/default_step.h"

#include <algorithm>

#include "core/edge_geometry.h"

namespace fairway::bench {

double default_step(PackedFlow& flow) {
  constexpr double kFarAway = 1e6;
  const double bend = flow.bends(true).robust * 180.0 / 3.14159265358979;
  const double lambda = lambda_of_feature_angle(std::clamp(3.0 * bend, 12.0, 30.0), 1.0);
  flow.step(lambda, kStepSize, kFarAway);
  flow.displacement();
  return lambda;
}

}  // namespace fairway::bench
