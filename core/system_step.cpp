// One step by a linear system. Source: Hildebrandt & Polthier 2004, §5.1.

#include "core/system_step.h"

namespace fairway {
namespace {

constexpr double kTolerance = 1e-12;
constexpr int kMostIterations = 1000;
constexpr int kMostHalvings = 6;

}  // namespace

void SystemStep::find_velocity(const KernelFields<double>& fields, std::span<const Index> held,
                               bool prescribed) {
  velocity_.resize(mesh_.slot_count());
  for (std::size_t slot = 0; slot < velocity_.size(); ++slot) {
    const Quad<double>& h = fields.curvature[slot];
    velocity_[slot] = {h.x, h.y, h.z, 0.0};
    if (!prescribed) continue;
    const Quad<double>& v = fields.direction[slot];
    const double f = fields.value[slot];
    velocity_[slot] = {h.x - f * v.x, h.y - f * v.y, h.z - f * v.z, 0.0};
  }
  for (const Index slot : held) velocity_[slot] = {};
}

PackedFlow::Outcome SystemStep::solve(std::span<const Quad<double>> x,
                                      const KernelFields<double>& fields,
                                      std::span<const Index> held,
                                      const StepNumbers<double>& numbers,
                                      const FlowOptions& options) {
  find_velocity(fields, held, numbers.prescribed);
  const std::span<const std::uint8_t> strong(fields.strong,
                                             mesh_.column_count() + PackedMesh::kPadding);
  const bool implicit = options.integration == Integration::semi_implicit;
  PackedFlow::Outcome outcome;
  outcome.solved = false;
  outcome.time_step = numbers.time_step;
  right_side_.resize(velocity_.size());
  for (int halvings = 0; halvings <= kMostHalvings && !outcome.solved; ++halvings) {
    if (halvings > 0) outcome.time_step *= 0.5;
    const double s = outcome.time_step;
    system_.assemble(x, strong, held,
                     {.time_step = implicit ? s : 0.0,
                      .lambda = numbers.lambda,
                      .transition = numbers.transition,
                      .mass = options.mass.value_or(Mass::full)});
    for (std::size_t i = 0; i < velocity_.size(); ++i) {
      right_side_[i] = {-s * velocity_[i].x, -s * velocity_[i].y, -s * velocity_[i].z, 0.0};
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
