// One step by a linear system. Source: Hildebrandt & Polthier 2004, §5.1.

#include "core/system_step.h"

namespace fairway {
namespace {

constexpr double kTolerance = 1e-12;
constexpr int kMostIterations = 1000;
constexpr int kMostHalvings = 6;

}  // namespace

PackedFlow::Outcome SystemStep::solve(std::span<const Quad<double>> x,
                                      std::span<const Quad<double>> velocity,
                                      std::span<const std::uint8_t> strong,
                                      std::span<const Index> held,
                                      const StepNumbers<double>& numbers,
                                      const FlowOptions& options) {
  const bool implicit = options.integration == Integration::semi_implicit;
  PackedFlow::Outcome outcome;
  outcome.solved = false;
  outcome.time_step = numbers.time_step;
  right_side_.resize(velocity.size());
  for (int halvings = 0; halvings <= kMostHalvings && !outcome.solved; ++halvings) {
    if (halvings > 0) outcome.time_step *= 0.5;
    const double s = outcome.time_step;
    system_.assemble(x, strong, held,
                     {.time_step = implicit ? s : 0.0,
                      .lambda = numbers.lambda,
                      .transition = numbers.transition,
                      .mass = options.mass.value_or(Mass::full)});
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      right_side_[i] = {-s * velocity[i].x, -s * velocity[i].y, -s * velocity[i].z, 0.0};
    }
    const SolverReport solved =
        system_.solve(right_side_, kTolerance, kMostIterations, displacement_);
    outcome.solver_iterations += solved.iterations;
    outcome.solver_residual = solved.residual;
    outcome.solved = solved.converged;
  }
  return outcome;
}

}  // namespace fairway
