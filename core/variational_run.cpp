// The variational method as a run: options in, report out.

#include "core/variational_run.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/edge_geometry.h"
#include "core/features.h"
#include "core/run_report.h"
#include "core/surface_geometry.h"
#include "core/variational.h"

namespace fairway {
namespace {

// Features of a denoised surface, in degrees: edges bent by more than three deviations of the rest.
constexpr double kFeatureDeviations = 3.0;
constexpr double kSmallestFeatureAngle = 12.0;
constexpr double kLargestFeatureAngle = 30.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;

double feature_angle(const TriangleMesh& mesh, std::span<const Vec3> x, const FlowOptions& options,
                     double mean_edge) {
  if (options.lambda) return feature_angle_of_lambda(*options.lambda, mean_edge);
  if (options.feature_angle) return *options.feature_angle;
  const FaceGeometry faces = face_geometry(mesh, x, smallest_area(mean_edge));
  const double bend = robust_bend(mesh, edge_mean_curvature(mesh, x, faces)) * kDegrees;
  return std::clamp(kFeatureDeviations * bend, kSmallestFeatureAngle, kLargestFeatureAngle);
}

FlowStep told(const VariationalStep& step, double mean_edge) {
  FlowStep out;
  out.step = step.step;
  out.of = kMostVariationalSteps;
  out.feature_angle = step.lambda * kDegrees;
  out.lambda = lambda_of_feature_angle(out.feature_angle, mean_edge);
  out.displacement = step.displacement;
  out.solver_iterations = step.solver_iterations;
  out.mu = step.mu;
  out.degrees_of_freedom = step.degrees_of_freedom;
  out.cross_validation = step.gcv;
  return out;
}

}  // namespace

Result<Denoised> run_variational(const TriangleMesh& surface, const FlowOptions& options,
                                 const FlowObserver& observer, const std::stop_token& stop,
                                 const Execution& execution) {
  const double mean_edge = surface.mean_edge_length();
  Denoised out;
  FlowReport& report = out.report;
  report.mean_edge_length = mean_edge;
  int told_of = 0;  // a path that begins anew for another kind of noise is no step back
  const auto observe = [&](const VariationalStep& step) {
    if (step.step <= told_of) return;
    told_of = step.step;
    if (observer) observer(told(step, mean_edge));
  };
  const std::vector<unsigned char> held = held_vertices(surface, options);
  const bool moves = std::count(held.begin(), held.end(), 0) > 0;
  VariationalOptions choices{options.strength, options.noise, options.surface, execution.threads};
  if (!moves) choices.strength = 0.0;
  Result<VariationalResult> result = denoise_variational(surface, held, choices, observe, stop);
  if (!result) return result.error();
  out.positions = std::move(result->positions);
  for (const VariationalStep& step : result->report.path) {
    report.steps.push_back(told(step, mean_edge));
  }
  report.noise = result->report.noise / mean_edge;
  report.noise_kind = result->report.kind;
  report.chosen_step = result->report.chosen;
  report.strength = result->report.strength;
  report.pass_band = result->report.pass_band;
  report.notes = std::move(result->report.notes);
  if (!moves) {
    report.notes.emplace_back("Every vertex is fixed, so the surface stays as it is.");
  }
  if (options.find_features) {
    report.feature_angle = feature_angle(surface, out.positions, options, mean_edge);
    report.lambda =
        options.lambda.value_or(lambda_of_feature_angle(report.feature_angle, mean_edge));
    out.features =
        feature_vertices(surface, out.positions, {report.lambda, options.guards.min_component});
  }
  compare_surfaces(surface, out.positions, mean_edge, report);
  return out;
}

NoiseFinding look_for_noise(const TriangleMesh& surface, const Execution& execution) {
  const VariationalReport found = find_variational_noise(surface, execution.threads);
  return {surface.mean_edge_length(), found.noise / surface.mean_edge_length(), found.kind,
          found.kind == FoundNoise::none ? 0 : kMostVariationalSteps};
}

}  // namespace fairway
