// One run of a flow: choices, guards, steps until the noise is gone, report.
// Source: Hildebrandt & Polthier 2004, eqs. (6)–(11), Table 1; the automatic run's constants are
// those of the resolved formulas §5.

#include "core/flow_run.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "core/edge_geometry.h"
#include "core/features.h"
#include "core/guards.h"
#include "core/packed_flow.h"
#include "core/run_report.h"
#include "core/surface_geometry.h"

namespace fairway {
namespace {

constexpr double kAutomaticStepSize = 0.1;
constexpr int kAutomaticMostSteps = 100;
// Features lie three deviations of the noise's bend out, within these bounds, in degrees.
constexpr double kFeatureDeviations = 3.0;
constexpr double kSmallestFeatureAngle = 12.0;
constexpr double kLargestFeatureAngle = 30.0;
// The run has removed the noise when the rms displacement is this many σ̂.
constexpr double kRemovedMeanCurvature = 0.95;
constexpr double kRemovedPrescribed = 1.1;
// Below this σ̂ / L, or this roughness of the curvature, an automatic run finds nothing to remove.
constexpr double kNoNoise = 0.001;
constexpr double kSmooth = 0.25;
constexpr double kDivergedBoxes = 10.0;

/// One run of a flow on one surface.
class FlowRun {
 public:
  FlowRun(const TriangleMesh& mesh, const FlowOptions& options, const Execution& execution)
      : mesh_(mesh),
        options_(options),
        execution_(execution),
        held_(held_vertices(mesh, options)),
        moving_(static_cast<std::size_t>(std::count(held_.begin(), held_.end(), 0))),
        x_(mesh.positions()) {}

  Result<Denoised> run(const FlowObserver& observer, const std::stop_token& stop);

 private:
  void begin();
  void load();
  void unfold_if_folded();
  int choose_most_steps();
  bool is_clean();
  bool noise_is_removed() const;
  Result<FlowStep> step(int number);
  double choose_feature_angle() const;
  void choose_feature_size();
  std::vector<unsigned char> find_features();
  FlowReport finish();

  const TriangleMesh& mesh_;
  const FlowOptions& options_;
  const Execution& execution_;
  const std::vector<unsigned char> held_;
  const std::size_t moving_;
  std::vector<Vec3> x_;
  std::unique_ptr<PackedFlow> flow_;
  PackedFlow::Bends bends_;  // of the start
  double mean_edge_ = 0.0;
  double bound_ = 0.0;  // of coordinates, in mean edges
  int most_steps_ = 0;
  FlowReport report_;
};

/// (Re)starts the kernels from x_.
void FlowRun::load() {
  mean_edge_ = flow_ ? mean_edge_length(mesh_, x_) : mesh_.mean_edge_length();
  flow_ = PackedFlow::create(mesh_, x_, mean_edge_, held_, options_, execution_);
  bends_ = flow_->bends(false);
}

void FlowRun::unfold_if_folded() {
  if (!options_.guards.unfold || !bends_.folded) return;
  report_.unfold_rounds = unfold(mesh_, held_, x_);
  load();
}

void FlowRun::begin() {
  load();
  most_steps_ = choose_most_steps();
  if (most_steps_ > 0) unfold_if_folded();
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh_.positions()) box.extend(p);
  bound_ = kDivergedBoxes * box.diagonal().norm() / mean_edge_;
  flow_->mark_start();
  report_.mean_edge_length = mean_edge_;
  report_.noise = noise_estimate(bends_.robust);
  report_.step_size = options_.step_size.value_or(kAutomaticStepSize);
  const bool features_at_rest = options_.find_features && most_steps_ == 0;
  if (!is_anisotropic(options_.method) && !features_at_rest &&
      (options_.lambda || options_.feature_angle)) {
    report_.notes.emplace_back(
        "This method detects no features: lambda and feature_angle are not used.");
  }
}

int FlowRun::choose_most_steps() {
  const int wanted =
      options_.method == Method::none ? 0 : options_.steps.value_or(kAutomaticMostSteps);
  if (wanted == 0) return 0;
  if (moving_ == 0) {
    report_.notes.emplace_back("Every vertex is fixed, so the surface stays as it is.");
    return 0;
  }
  return !options_.steps && is_clean() ? 0 : wanted;
}

/// An automatic run leaves a surface without noise as it is: smooth curvature is not noise.
bool FlowRun::is_clean() {
  const bool clean = noise_estimate(bends_.robust) < kNoNoise || flow_->roughness() < kSmooth;
  if (clean) {
    report_.notes.emplace_back(
        "No noise was found, so the surface stays as it is; give steps to smooth it all the same.");
  }
  return clean;
}

bool FlowRun::noise_is_removed() const {
  if (options_.steps || report_.steps.empty()) return false;
  const double removed =
      is_prescribed(options_.method) ? kRemovedPrescribed : kRemovedMeanCurvature;
  return report_.steps.back().displacement >= removed * report_.noise;
}

double FlowRun::choose_feature_angle() const {
  if (options_.lambda) return feature_angle_of_lambda(*options_.lambda, mean_edge_);
  if (options_.feature_angle) return *options_.feature_angle;
  const double bend = flow_->bends(true).robust * 180.0 / std::numbers::pi;
  return std::clamp(kFeatureDeviations * bend, kSmallestFeatureAngle, kLargestFeatureAngle);
}

/// Feature angle and λ of now, into the report.
void FlowRun::choose_feature_size() {
  report_.feature_angle = choose_feature_angle();
  report_.lambda =
      options_.lambda.value_or(lambda_of_feature_angle(report_.feature_angle, mean_edge_));
}

Result<FlowStep> FlowRun::step(int number) {
  FlowStep step;
  step.step = number;
  step.of = most_steps_;
  if (is_anisotropic(options_.method)) {
    choose_feature_size();
    step.feature_angle = report_.feature_angle;
    step.lambda = report_.lambda;
  }
  const PackedFlow::Outcome outcome =
      flow_->step(step.lambda / mean_edge_, report_.step_size, bound_);
  if (!outcome.solved) {
    return Error{ErrorCode::diverged,
                 "The linear system of step " + std::to_string(number) +
                     " has no solution within reach; use a smaller step_size."};
  }
  if (!outcome.in_bounds) {
    return Error{ErrorCode::diverged,
                 "The flow diverged at step " + std::to_string(number) +
                     (outcome.finite ? ": a vertex went beyond ten bounding boxes"
                                     : ": a position is not a finite number") +
                     "; use a smaller step_size or leave guards.local_step on."};
  }
  step.step_size = outcome.time_step;
  step.solver_iterations = outcome.solver_iterations;
  step.solver_residual = outcome.solver_residual;
  step.displacement = flow_->displacement();
  return step;
}

/// Features of the last step, or of the surface as it is where there was none.
std::vector<unsigned char> FlowRun::find_features() {
  if (!options_.find_features) return {};
  if (report_.steps.empty()) {
    choose_feature_size();
    return feature_vertices(mesh_, x_, {report_.lambda, options_.guards.min_component});
  }
  if (is_anisotropic(options_.method)) return flow_->features();
  report_.notes.emplace_back("This method takes no vertex for a feature.");
  return std::vector<unsigned char>(mesh_.vertex_count());
}

FlowReport FlowRun::finish() {
  if (report_.halved_steps > 0) {
    report_.notes.push_back(std::to_string(report_.halved_steps) +
                            " steps were halved until their linear systems could be solved.");
  }
  compare_surfaces(mesh_, x_, mean_edge_, report_);
  return std::move(report_);
}

Result<Denoised> FlowRun::run(const FlowObserver& observer, const std::stop_token& stop) {
  begin();
  for (int number = 1; number <= most_steps_ && !noise_is_removed(); ++number) {
    if (stop.stop_requested()) {
      return Error{ErrorCode::canceled, "The run was canceled between two steps."};
    }
    const Result<FlowStep> done = step(number);
    if (!done) return done.error();
    if (done->step_size < report_.step_size) ++report_.halved_steps;
    report_.steps.push_back(*done);
    if (observer) observer(*done);
  }
  std::vector<unsigned char> features = find_features();
  if (!report_.steps.empty()) x_ = flow_->positions(x_);
  FlowReport report = finish();
  return Denoised{std::move(x_), std::move(features), std::move(report)};
}

}  // namespace

Result<Denoised> run_flow(const TriangleMesh& surface, const FlowOptions& options,
                          const FlowObserver& observer, const std::stop_token& stop,
                          const Execution& execution) {
  return FlowRun(surface, options, execution).run(observer, stop);
}

}  // namespace fairway
