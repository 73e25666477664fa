#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/execution.h"
#include "core/flow_options.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// One step as it was done.
struct FlowStep {
  int step = 0;                ///< 1-based
  int of = 0;                  ///< the most steps there can be
  double feature_angle = 0.0;  ///< degrees; 0 for isotropic flows
  double lambda = 0.0;         ///< length; 0 for isotropic flows
  /// rms displacement so far of the vertices that may move, along the start normals, in mean edges
  double displacement = 0.0;
  double step_size = 0.0;        ///< τ as done; 0 for the variational method
  int solver_iterations = 0;     ///< of the linear system, where there is one
  double solver_residual = 0.0;  ///< its true relative residual; flows only
  // Of the variational method only, see VariationalStep.
  double mu = 0.0;
  double degrees_of_freedom = 0.0;
  double cross_validation = 0.0;  ///< in squared mean edges
};

/// What noise a run found. `none`: the surface stays as it is.
enum class FoundNoise { none, white, correlated };

/// What a run found, chose and did.
struct FlowReport {
  Method method = Method::none;
  double mean_edge_length = 0.0;  ///< L, length, after unfolding
  double noise = 0.0;             ///< σ̂ / L at the start, after unfolding
  double step_size = 0.0;         ///< τ as used
  /// Of the last step or, where none was done, of the features that were asked for; else 0.
  double feature_angle = 0.0;  ///< degrees
  double lambda = 0.0;         ///< length
  int unfold_rounds = 0;
  int halved_steps = 0;  ///< steps made smaller because their system was not solved
  FoundNoise noise_kind = FoundNoise::white;  ///< flows do not look for correlation
  /// Of the variational method: the step that is the answer; 0 where it is the input or a low pass.
  int chosen_step = 0;
  double strength = 0.0;   ///< of that step, see FlowOptions
  double pass_band = 0.0;  ///< of the low pass that is the answer, in (0, 2]; else 0
  std::vector<FlowStep> steps;
  double volume_before = 0.0;  ///< signed, about the centroid; length³
  double volume_after = 0.0;
  double area_before = 0.0;  ///< length²
  double area_after = 0.0;
  double rms_displacement = 0.0;  ///< of all vertices, in mean edges
  double max_displacement = 0.0;  ///< in mean edges
  std::size_t flipped_faces = 0;  ///< faces turned by more than 90° against the input
  std::vector<std::string> notes;
};

/// Positions per surface vertex, relative to the surface's origin, and the report.
struct Denoised {
  std::vector<Vec3> positions;
  /// If asked for, 1 per surface vertex that the last step took for a feature, eq. (11); all 0 for
  /// isotropic flows. Without any step: the features of the surface as it is.
  std::vector<unsigned char> features;
  FlowReport report;
};

/// What an automatic run with the default options finds before its first step.
struct NoiseFinding {
  double mean_edge_length = 0.0;  ///< L, length
  double noise = 0.0;             ///< σ̂ / L: FlowReport::noise of that run
  FoundNoise kind = FoundNoise::none;
  int most_steps = 0;  ///< that run takes no more; it may end before

  /// That run would leave the surface as it is.
  bool clean() const { return most_steps == 0; }
};

/// Called after every step, from the thread that runs denoise().
using FlowObserver = std::function<void(const FlowStep&)>;

/// Denoises a surface as `options` say. `steps` = 0 or method `none` return the input
/// positions unchanged, and so does an automatic run on a surface without noise.
/// Deterministic. Errors: diverged (a position not finite or outside ten bounding boxes, with the
/// step and which of the two; a linear system without solution), canceled (stop requested; looked
/// at between steps), invalid_parameters (a fixed vertex that is not in the source).
Result<Denoised> denoise(const TriangleMesh& surface, const FlowOptions& options,
                         const FlowObserver& observer = {}, std::stop_token stop = {},
                         const Execution& execution = {});

/// Looks for noise and moves nothing.
NoiseFinding find_noise(const TriangleMesh& surface, const Execution& execution = {});

}  // namespace fairway
