// The flows of the paper as one loop: geometry, weights, prescription, step, report.
// Source: Hildebrandt & Polthier 2004, eqs. (6)–(11), Table 1; the automatic run's constants are
// those of the resolved formulas §5.

#include "core/denoise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/edge_geometry.h"
#include "core/guards.h"
#include "core/prescribed.h"
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

/// All that a step computes of the surface before it moves.
struct Geometry {
  FaceGeometry faces;
  EdgeCurvature edges;
};

Geometry geometry_of(const TriangleMesh& mesh, std::span<const Vec3> x, double smallest) {
  Geometry out;
  out.faces = face_geometry(mesh, x, smallest);
  out.edges = edge_mean_curvature(mesh, x, out.faces);
  return out;
}

/// One run of a flow on one surface.
class FlowRun {
 public:
  FlowRun(const TriangleMesh& mesh, const FlowOptions& options)
      : mesh_(mesh),
        options_(options),
        held_(options.boundary == Boundary::fixed ? mesh.boundary_vertex()
                                                  : std::vector<unsigned char>(mesh.vertex_count())),
        x_(mesh.positions()) {}

  Result<Denoised> run(const FlowObserver& observer, const std::stop_token& stop);

 private:
  void begin();
  bool is_clean();
  bool noise_is_removed() const;
  FlowStep step(int number);
  double choose_lambda(const EdgeCurvature& edges) const;
  std::vector<double> step_lengths(const FaceGeometry& faces) const;
  std::vector<Vec3> velocity(const Geometry& now, double lambda) const;
  double normal_displacement() const;
  bool diverged() const;
  FlowReport finish();

  const TriangleMesh& mesh_;
  const FlowOptions& options_;
  const std::vector<unsigned char> held_;
  std::vector<Vec3> x_;
  std::vector<Vec3> start_;    // after unfolding
  std::vector<Vec3> normals_;  // of start_
  double mean_edge_ = 0.0;
  double smallest_area_ = 0.0;
  double step_size_ = 0.0;  // τ
  int most_steps_ = 0;
  FlowReport report_;
};

void FlowRun::begin() {
  report_.volume_before = enclosed_volume(mesh_, x_);
  const double smallest = smallest_area(mean_edge_length(mesh_, x_));
  report_.area_before = surface_area(face_geometry(mesh_, x_, smallest));
  most_steps_ = options_.method == Method::none ? 0 : options_.steps.value_or(kAutomaticMostSteps);
  if (most_steps_ > 0 && !options_.steps && is_clean()) most_steps_ = 0;
  if (most_steps_ > 0 && options_.guards.unfold) report_.unfold_rounds = unfold(mesh_, held_, x_);
  start_ = x_;
  mean_edge_ = mean_edge_length(mesh_, x_);
  smallest_area_ = smallest_area(mean_edge_);
  const Geometry now = geometry_of(mesh_, x_, smallest_area_);
  normals_ = vertex_normals(mesh_, now.faces);
  step_size_ = options_.step_size.value_or(kAutomaticStepSize);
  report_.mean_edge_length = mean_edge_;
  report_.noise = noise_estimate(robust_bend(mesh_, now.edges));
  report_.step_size = step_size_;
  if (!is_anisotropic(options_.method) && (options_.lambda || options_.feature_angle)) {
    report_.notes.emplace_back("This method detects no features: lambda and feature_angle are not used.");
  }
}

/// An automatic run leaves a surface without noise as it is: smooth curvature is not noise.
bool FlowRun::is_clean() {
  const Geometry now = geometry_of(mesh_, x_, smallest_area(mean_edge_length(mesh_, x_)));
  const bool clean = noise_estimate(robust_bend(mesh_, now.edges)) < kNoNoise ||
                     curvature_roughness(mesh_, x_, now.faces, now.edges) < kSmooth;
  if (clean) {
    report_.notes.emplace_back(
        "No noise was found, so the surface stays as it is; give steps to smooth it all the same.");
  }
  return clean;
}

bool FlowRun::noise_is_removed() const {
  if (options_.steps || report_.steps.empty()) return false;
  const double removed = is_prescribed(options_.method) ? kRemovedPrescribed : kRemovedMeanCurvature;
  return report_.steps.back().displacement >= removed * report_.noise;
}

double FlowRun::choose_lambda(const EdgeCurvature& edges) const {
  if (options_.lambda) return *options_.lambda;
  double angle = 0.0;
  if (options_.feature_angle) {
    angle = *options_.feature_angle;
  } else {
    const double bend = robust_bend(mesh_, edges) * 180.0 / std::numbers::pi;
    angle = std::clamp(kFeatureDeviations * bend, kSmallestFeatureAngle, kLargestFeatureAngle);
  }
  return lambda_of_feature_angle(angle, mean_edge_);
}

std::vector<double> FlowRun::step_lengths(const FaceGeometry& faces) const {
  const double s = step_size_ * mean_edge_ * mean_edge_;
  std::vector<double> lengths = lumped_mass(mesh_, faces);
  for (double& mass : lengths) mass = mass > 0.0 ? s / mass : 0.0;
  if (!options_.guards.local_step) return lengths;
  const std::vector<double> stable = largest_stable_step(mesh_, x_, faces);
  for (std::size_t v = 0; v < lengths.size(); ++v) lengths[v] = std::min(lengths[v], stable[v]);
  return lengths;
}

/// H_A − f̃ V_A per vertex (H_A alone for the mean curvature flows).
std::vector<Vec3> FlowRun::velocity(const Geometry& now, double lambda) const {
  Features features;
  if (is_anisotropic(options_.method)) {
    features = detect_features(mesh_, now.edges, lambda, options_.transition,
                               options_.guards.min_component);
  } else {
    features.vertex.resize(mesh_.vertex_count(), 0);
  }
  std::vector<Vec3> velocity = mean_curvature_vector(mesh_, now.edges, features.weights);
  if (!is_prescribed(options_.method)) return velocity;
  const PrescribedCurvature prescribed =
      prescribed_curvature(mesh_, x_, now.faces, velocity, features.vertex, mean_edge_,
                           options_.curvature_smoothing, options_.conventions);
  for (std::size_t v = 0; v < velocity.size(); ++v) velocity[v] -= prescribed.vector(v);
  return velocity;
}

FlowStep FlowRun::step(int number) {
  const Geometry now = geometry_of(mesh_, x_, smallest_area_);
  FlowStep step{.step = number, .of = most_steps_};
  if (is_anisotropic(options_.method)) {
    step.lambda = choose_lambda(now.edges);
    step.feature_angle = feature_angle_of_lambda(step.lambda, mean_edge_);
  }
  const std::vector<Vec3> velocity = this->velocity(now, step.lambda);
  const std::vector<double> lengths = step_lengths(now.faces);
  for (std::size_t v = 0; v < x_.size(); ++v) {
    if (held_[v] == 0) x_[v] -= lengths[v] * velocity[v];
  }
  step.displacement = normal_displacement();
  return step;
}

double FlowRun::normal_displacement() const {
  double sum = 0.0;
  for (std::size_t v = 0; v < x_.size(); ++v) {
    const double d = (x_[v] - start_[v]).dot(normals_[v]) / mean_edge_;
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(x_.size()));
}

/// Some position is not finite, or further from the centroid than ten bounding boxes.
bool FlowRun::diverged() const {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh_.positions()) box.extend(p);
  const double limit = kDivergedBoxes * box.diagonal().norm();
  return std::any_of(x_.begin(), x_.end(), [&](const Vec3& p) { return !(p.norm() <= limit); });
}

FlowReport FlowRun::finish() {
  const FaceGeometry before = face_geometry(mesh_, mesh_.positions(), smallest_area_);
  const FaceGeometry after = face_geometry(mesh_, x_, smallest_area_);
  report_.volume_after = enclosed_volume(mesh_, x_);
  report_.area_after = surface_area(after);
  for (std::size_t f = 0; f < after.normals.size(); ++f) {
    if (before.normals[f].dot(after.normals[f]) < 0.0) ++report_.flipped_faces;
  }
  double sum = 0.0;
  double most = 0.0;
  for (std::size_t v = 0; v < x_.size(); ++v) {
    const double d = (x_[v] - mesh_.positions()[v]).norm() / mean_edge_;
    sum += d * d;
    most = std::max(most, d);
  }
  report_.rms_displacement = std::sqrt(sum / static_cast<double>(x_.size()));
  report_.max_displacement = most;
  return std::move(report_);
}

Result<Denoised> FlowRun::run(const FlowObserver& observer, const std::stop_token& stop) {
  begin();
  for (int number = 1; number <= most_steps_ && !noise_is_removed(); ++number) {
    if (stop.stop_requested()) {
      return Error{ErrorCode::canceled, "The run was canceled between two steps."};
    }
    report_.steps.push_back(step(number));
    if (diverged()) {
      return Error{ErrorCode::diverged,
                   "The flow left all bounds at step " + std::to_string(number) +
                       "; use a smaller step_size or leave guards.local_step on."};
    }
    if (observer) observer(report_.steps.back());
  }
  FlowReport report = finish();
  return Denoised{std::move(x_), std::move(report)};
}

}  // namespace

Result<Denoised> denoise(const TriangleMesh& surface, const FlowOptions& options,
                         const FlowObserver& observer, std::stop_token stop) {
  return FlowRun(surface, options).run(observer, stop);
}

}  // namespace fairway
