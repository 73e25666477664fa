#pragma once

#include <optional>
#include <vector>

#include "core/index.h"

namespace fairway {

/// How the surface is denoised. `none` computes curvature only.
enum class Method {
  variational,  ///< prescribed curvature by annealed minimisation, finds all of its numbers itself
  none,
  mean_curvature,          ///< isotropic mean curvature flow, eq. (8) with w = 1
  anisotropic,             ///< anisotropic mean curvature flow (AMC), eq. (7), (8)
  prescribed,              ///< isotropic prescribed mean curvature flow, eq. (10)
  anisotropic_prescribed,  ///< anisotropic prescribed mean curvature flow (PMC), eq. (11)
};

/// `semi_implicit`: eqs. (12), (13), one nonsymmetric linear system a step.
enum class Integration { explicit_euler, semi_implicit };

/// Mass matrix M; after (7). Automatic: lumped for explicit steps, full for semi-implicit ones.
enum class Mass { lumped, full };

/// How f is found from H_A and V_A: by length, by projection ⟨H_A, V_A⟩/|V_A|², or f = M⁻¹ H (the
/// paper's first choice for the isotropic flow, not stationary on constant mean curvature).
enum class CurvatureMeasure { length, project, mass };

/// `free`: the formulas as they stand. `fixed`: boundary vertices do not move.
enum class Boundary { free, fixed };

/// `recommended`: feature vertices average over feature neighbours only. `paper`: the literal text.
enum class Conventions { recommended, paper };

/// What the variational method takes the noise for. `white`: of each vertex by itself.
/// `correlated`: of neighbours alike, as scanners and reconstructions leave it. `automatic`: looks.
enum class NoiseKind { automatic, white, correlated };

/// What the variational method expects of the surface. `sharp`: edges, which a low pass would
/// round, so that none is tried. `smooth`: none finer than 8°. `automatic`: whatever is there.
enum class SurfaceKind { automatic, sharp, smooth };

/// Smoothing of the prescribed curvature: `passes` times f ← (1 − fraction) f + fraction · average
/// of f over the neighbours.
struct CurvatureSmoothing {
  int passes = 1;
  double fraction = 1.0;
};

/// Guards around the plain formulas; each can be switched off.
struct Guards {
  bool unfold = true;      ///< relax edges bent by more than 120° before the first step
  int min_component = 12;  ///< smaller groups of strong edges (in vertices) are noise; 0 = off
  bool local_step = true;  ///< per-vertex step min(s / M_pp, ½ / K_pp)
};

/// All choices of one run. An empty optional is an automatic choice. The variational method looks
/// at `strength`, `noise`, `surface`, `boundary`, `fixed_vertices` and, for features that are asked
/// for, at `feature_angle` and `lambda`; the flows look at all but the first three.
struct FlowOptions {
  Method method = Method::variational;
  /// In [0, 1], along the path of minimisations: 0 leaves the surface as it is, 1 is the end of the
  /// path; automatic: where cross-validation is least.
  std::optional<double> strength;
  NoiseKind noise = NoiseKind::automatic;
  SurfaceKind surface = SurfaceKind::automatic;
  Integration integration = Integration::explicit_euler;
  std::optional<Mass> mass;
  CurvatureMeasure measure = CurvatureMeasure::length;
  std::optional<int> steps;             ///< automatic: until the noise found is removed
  std::optional<double> step_size;      ///< τ, dimensionless: s = τ L²; automatic: 0.1
  std::optional<double> feature_angle;  ///< degrees, λ = 2 L sin(angle / 2); automatic: per step
  std::optional<double> lambda;         ///< length; takes the place of feature_angle
  double transition = 10.0;             ///< r of the weight w_{λ,r}
  CurvatureSmoothing curvature_smoothing;
  Boundary boundary = Boundary::free;
  /// Source vertices that do not move, and with each all that lie at its place; any order.
  std::vector<Index> fixed_vertices;
  Conventions conventions = Conventions::recommended;
  Guards guards;
  bool find_features = false;  ///< fill Denoised::features
};

/// True for the paper's flows, which take steps.
constexpr bool is_flow(Method method) {
  return method != Method::none && method != Method::variational;
}

/// True for the methods that detect features, and so use λ.
constexpr bool is_anisotropic(Method method) {
  return method == Method::anisotropic || method == Method::anisotropic_prescribed;
}

/// True for the methods that prescribe a curvature.
constexpr bool is_prescribed(Method method) {
  return method == Method::prescribed || method == Method::anisotropic_prescribed;
}

}  // namespace fairway
