#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/denoise.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Most iterates of a path.
inline constexpr int kMostVariationalSteps = 24;

/// Choices of a run, see FlowOptions.
struct VariationalOptions {
  std::optional<double> strength;
  NoiseKind noise = NoiseKind::automatic;
  SurfaceKind surface = SurfaceKind::automatic;
  unsigned threads = 1;  ///< at least 1; no influence on the result
};

/// One iterate of the variational method.
struct VariationalStep {
  int step = 0;                   ///< 1-based
  double mu = 0.0;                ///< weight of the edges beside the data, dimensionless
  double lambda = 0.0;            ///< threshold of the residual bend at the median edge, radians
  double degrees_of_freedom = 0;  ///< share of the vertices' freedom that is left, in [0, 1]
  double gcv = 0.0;  ///< generalised cross-validation, in squared mean edges: the least is chosen
  double displacement = 0.0;  ///< rms, along the normals of the start, in mean edges
  int solver_iterations = 0;
};

/// What the path found and chose.
struct VariationalReport {
  double noise = 0.0;  ///< σ, length, along the normals
  FoundNoise kind = FoundNoise::white;
  int chosen = 0;          ///< number of the iterate that is the answer; 0 where none is
  double strength = 0.0;   ///< its place on the path, in [0, 1]
  double pass_band = 0.0;  ///< of the low pass that is the answer; else 0
  std::vector<std::string> notes;
  std::vector<VariationalStep> path;
};

/// Positions per surface vertex, relative to the surface's origin.
struct VariationalResult {
  std::vector<Vec3> positions;
  VariationalReport report;
};

/// Removes noise by an annealed minimisation that keeps close to the input, makes weighted edges as
/// bent as a smoothed shape operator prescribes, and stops where cross-validation with a random
/// probe is least, or at the `strength` of the options; without that a low pass may be the answer
/// instead, and a surface without noise comes back as it was. Folded faces are mended last. Finds
/// all of its numbers from the mesh. `held`: 1 per surface vertex that does not move. `observer` is
/// told every iterate; a path that begins anew, for another kind of noise, counts from 1 again.
/// Deterministic: fixed seeds, the same bits at any number of threads. Source: core/EQUATIONS.md,
/// "Variational method"; edge curvature and weight w_{λ,r} are the paper's. Errors: canceled
/// (looked at between iterates), diverged (a position is not finite).
Result<VariationalResult> denoise_variational(
    const TriangleMesh& mesh, std::span<const unsigned char> held,
    const VariationalOptions& options = {},
    const std::function<void(const VariationalStep&)>& observer = {}, std::stop_token stop = {});

/// Looks for noise and moves nothing: `noise` and `kind` of the report of a default run.
VariationalReport find_variational_noise(const TriangleMesh& mesh, unsigned threads = 1);

}  // namespace fairway
