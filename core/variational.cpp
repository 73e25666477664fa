// The noise is looked at, the path is walked, and the best estimate on it or beside it chosen.

#include "core/variational.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/edge_geometry.h"
#include "core/edge_stencils.h"
#include "core/fold_guard.h"
#include "core/guards.h"
#include "core/low_pass.h"
#include "core/noise_model.h"
#include "core/surface_geometry.h"
#include "core/thread_team.h"
#include "core/variational_path.h"

namespace fairway {
namespace {

using Outcome = VariationalPath::Outcome;

constexpr int kMost = kMostVariationalSteps;
constexpr int kEarliestLeast = 6;  // the least GCV is looked for from this iterate on
constexpr int kPatience = 3;
constexpr int kEvennessStep = 5;
constexpr int kCorrelationStep = 7;
constexpr int kColourStep = 11;
constexpr double kNoNoise = 1e-9;  // of a mean edge
// Below this noise by the bend of edges, or this roughness of the curvature, there is none.
constexpr double kNoBend = 0.001;
constexpr double kSmooth = 0.25;
// Below this much noise, what neighbours have in common is detail.
constexpr double kLittleNoise = 0.05;
constexpr double kDetailCorrelation = 0.2;
// With more of it only where they have most in common.
constexpr double kCoarseDetailCorrelation = 0.3;
// Noise of σ bends an edge by less than this times σ once in forty times; clean parts have many
// such.
constexpr double kFlat = 0.05;
constexpr double kManyFlat = 0.25;
// So have impulses, which leave most vertices alone: few of them have all of the noise, everywhere.
constexpr double kImpulseEvenness = 0.45;
constexpr double kImpulseUnevenness = 0.35;
constexpr double kNoiseCorrelation = 0.13;
constexpr double kScannerCorrelation = 0.03;
constexpr double kLeastEvenness = 0.55;
constexpr double kUneven = 0.6;
constexpr int kColourUpdates = 2;
constexpr double kDegree = std::numbers::pi / 180.0;

/// f of a filter that was made from the noise it is to remove counts for more.
double penalised(double f) {
  return f + 0.25 * f * (1.0 - f) + 0.5 * std::min(f, 0.05) * (1.0 - f);
}

double cross_validation(const Outcome& outcome, double freedom) {
  return outcome.misfit / ((1.0 - freedom) * (1.0 - freedom));
}

/// Face normals averaged to vertices, and these once over the ring; unit or zero.
std::vector<Vec3> smooth_normals(const TriangleMesh& mesh) {
  const FaceGeometry faces =
      face_geometry(mesh, mesh.positions(), smallest_area(mesh.mean_edge_length()));
  const std::vector<Vec3> once = vertex_normals(mesh, faces);
  std::vector<Vec3> normals = once;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    for (const Index w : mesh.rings()[v]) normals[v] += once[w];
    const double length = normals[v].norm();
    normals[v] = length > 0.0 ? Vec3(normals[v] / length) : Vec3(Vec3::Zero());
  }
  return normals;
}

std::vector<Vec3> scaled(std::span<const Vec3> positions, double factor) {
  std::vector<Vec3> out(positions.begin(), positions.end());
  for (Vec3& p : out) p *= factor;
  return out;
}

/// Smooth curvature, however strong, is not noise.
bool is_smooth(const TriangleMesh& mesh) {
  const double mean_edge = mesh.mean_edge_length();
  const FaceGeometry faces = face_geometry(mesh, mesh.positions(), smallest_area(mean_edge));
  const EdgeCurvature edges = edge_mean_curvature(mesh, mesh.positions(), faces);
  return noise_estimate(robust_bend(mesh, edges)) < kNoBend ||
         curvature_roughness(mesh, mesh.positions(), faces, edges) < kSmooth;
}

/// One run on one surface.
class Run {
 public:
  using Observer = std::function<void(const VariationalStep&)>;

  Run(const TriangleMesh& mesh, std::span<const unsigned char> held,
      const VariationalOptions& options, Observer observer)
      : mesh_(mesh),
        held_of_vertex_(held),
        options_(options),
        observer_(std::move(observer)),
        mean_edge_(mesh.mean_edge_length()),
        team_(options.threads),
        stencils_(mesh),
        held_(stencils_.by_slot(held)),
        positions_(
            stencils_.by_slot(std::span<const Vec3>(scaled(mesh.positions(), 1.0 / mean_edge_)))),
        normals_(stencils_.by_slot(std::span<const Vec3>(smooth_normals(mesh)))),
        analysis_(stencils_, positions_, normals_),
        path_(stencils_, positions_, normals_, held_,
              {options.surface == SurfaceKind::smooth ? 8.0 * kDegree : kDegree}, team_) {}

  Result<VariationalResult> run(const std::stop_token& stop);
  Result<FoundNoise> look(const std::stop_token& stop);
  double sigma() const { return path_.noise().sigma * mean_edge_; }

 private:
  void restart(NoiseModel noise);
  Result<bool> step(const std::stop_token& stop);
  Result<FoundNoise> find_kind(const std::stop_token& stop);
  bool is_detail(double correlation) const;
  double share_of_flat_edges(double bend) const;
  Result<double> look_twice(const std::stop_token& stop);
  Result<bool> find_colour(int updates, const std::stop_token& stop);
  Result<bool> walk(const std::stop_token& stop);
  void take_least(const VariationalStep& step);
  void take_at(double place, const VariationalStep& step);
  void try_low_passes();
  std::vector<Vec3> positions() const;
  bool nothing_to_do() const;

  const TriangleMesh& mesh_;
  const std::span<const unsigned char> held_of_vertex_;
  const VariationalOptions& options_;
  const Observer observer_;
  const double mean_edge_;
  ThreadTeam team_;
  const EdgeStencils stencils_;
  const std::vector<unsigned char> held_;
  const std::vector<Vec3> positions_, normals_;
  const NoiseAnalysis analysis_;
  VariationalPath path_;
  double evenness_ = 1.0;
  double unevenness_ = 0.0;
  std::vector<Vec4> best_;
  Outcome best_outcome_;
  double least_ = std::numeric_limits<double>::infinity();
  int least_step_ = 0;  // of those that count for the end
  double least_late_ = std::numeric_limits<double>::infinity();
  VariationalReport report_;
};

bool Run::nothing_to_do() const {
  return stencils_.stencils().empty() || !(path_.noise().sigma > kNoNoise) ||
         !std::isfinite(path_.noise().sigma) || std::count(held_.begin(), held_.end(), 0) == 0;
}

/// Begins a path anew.
void Run::restart(NoiseModel noise) {
  path_.restart(std::move(noise));
  report_ = {};
  best_ = path_.start();
  least_ = least_late_ = std::numeric_limits<double>::infinity();
  least_step_ = 0;
}

/// The next iterate of the path.
Result<bool> Run::step(const std::stop_token& stop) {
  if (stop.stop_requested()) {
    return Error{ErrorCode::canceled, "The run was canceled between two iterates."};
  }
  const int number = static_cast<int>(report_.path.size()) + 1;
  const Outcome outcome = path_.iterate(number);
  if (!outcome.finite) {
    return Error{ErrorCode::diverged,
                 "The variational method diverged at iterate " + std::to_string(number) +
                     ": a position is not a finite number. Use one of the flows."};
  }
  VariationalStep step;
  step.step = number;
  step.mu = outcome.mu;
  step.lambda = outcome.lambda;
  step.degrees_of_freedom = outcome.freedom;
  step.gcv = cross_validation(outcome, penalised(outcome.freedom));
  step.displacement = outcome.rms;
  step.solver_iterations = outcome.solver_iterations;
  report_.path.push_back(step);
  if (options_.strength) {
    take_at(*options_.strength * kMost, step);
  } else {
    take_least(step);
  }
  if (observer_) observer_(step);
  return true;
}

/// The first iterates; returns how much more alike neighbours are than in the probe.
Result<double> Run::look_twice(const std::stop_token& stop) {
  for (int number = 1; number <= kCorrelationStep; ++number) {
    const Result<bool> done = step(stop);
    if (!done) return done.error();
    if (number != kEvennessStep) continue;
    const NoiseResidue left = path_.residue();
    evenness_ = analysis_.evenness(left);
    unevenness_ = analysis_.unevenness(left);
  }
  return analysis_.correlation(path_.residue());
}

Result<bool> Run::find_colour(int updates, const std::stop_token& stop) {
  NoiseAnalysis::Bands colour{1.0, 1.0, 1.0, 1.0, 1.0};
  for (int update = 0; update < updates; ++update) {
    restart(analysis_.coloured(colour, path_.noise().scale));
    for (int number = 1; number <= kColourStep; ++number) {
      const Result<bool> done = step(stop);
      if (!done) return done.error();
    }
    colour = analysis_.better_colour(colour, path_.residue(), path_.noise().scale);
  }
  restart(analysis_.coloured(colour, path_.noise().scale));
  return true;
}

/// Whether what was taken for noise is the shape: neighbours have much of it in common, or edges
/// are flat that noise would have bent.
bool Run::is_detail(double correlation) const {
  const double sigma = path_.noise().sigma;
  if (correlation > (sigma < kLittleNoise ? kDetailCorrelation : kCoarseDetailCorrelation)) {
    return true;
  }
  const bool impulses = evenness_ < kImpulseEvenness && unevenness_ > kImpulseUnevenness &&
                        unevenness_ < kUneven && correlation < kNoiseCorrelation;
  return !impulses && share_of_flat_edges(kFlat * sigma) > kManyFlat;
}

/// Share of the stencils whose bend at the start is less, radians.
double Run::share_of_flat_edges(double bend) const {
  const auto normal = [this](Index face) {
    const Triangle& f = stencils_.faces()[face];
    const Vec3 n = (positions_[f[1]] - positions_[f[0]]).cross(positions_[f[2]] - positions_[f[0]]);
    return Vec3(n.normalized());
  };
  std::size_t flat = 0;
  for (const EdgeStencil& s : stencils_.stencils()) {
    if ((normal(s.faces[0]) - normal(s.faces[1])).norm() < bend) ++flat;
  }
  return static_cast<double>(flat) / static_cast<double>(stencils_.stencils().size());
}

/// What the noise is; leaves a path for noise of that kind, begun or at its start.
Result<FoundNoise> Run::find_kind(const std::stop_token& stop) {
  restart(analysis_.white());
  if (nothing_to_do()) return FoundNoise::none;
  if (!options_.strength && options_.noise != NoiseKind::correlated && is_smooth(mesh_)) {
    return FoundNoise::none;
  }
  Result<double> correlation = look_twice(stop);
  if (!correlation) return correlation.error();
  if (!options_.strength && options_.noise != NoiseKind::correlated && is_detail(*correlation)) {
    return FoundNoise::none;
  }
  if (options_.noise == NoiseKind::white) return FoundNoise::white;
  const bool uneven = unevenness_ > kUneven;
  if (uneven) {
    std::vector<double> scale = analysis_.local_scale(path_.residue());
    restart(analysis_.coloured({1.0, 1.0, 1.0, 1.0, 1.0}, std::move(scale)));
    correlation = look_twice(stop);
    if (!correlation) return correlation.error();
  }
  const bool plain = *correlation > kNoiseCorrelation && (uneven || evenness_ > kLeastEvenness);
  const bool faint = uneven && *correlation > kScannerCorrelation;
  const bool found = path_.noise().sigma > kLittleNoise && (plain || faint);
  if (!found && options_.noise != NoiseKind::correlated) return FoundNoise::white;
  const bool weak = !plain && options_.noise != NoiseKind::correlated;
  const Result<bool> done = find_colour(weak ? 1 : kColourUpdates, stop);
  if (!done) return done.error();
  return FoundNoise::correlated;
}

void Run::take_least(const VariationalStep& step) {
  if (step.step >= kEarliestLeast && step.gcv < least_late_) {
    least_late_ = step.gcv;
    least_step_ = step.step;
  }
  if (!(step.gcv < least_)) return;
  least_ = step.gcv;
  best_ = path_.x();
  best_outcome_ = path_.judge(best_);
  report_.chosen = step.step;
}

/// Keeps what is at `place` between two iterates, where step is the later one.
void Run::take_at(double place, const VariationalStep& step) {
  const double share = place - (step.step - 1);
  if (share <= 0.0) return;
  for (std::size_t v = 0; v < best_.size(); ++v) {
    best_[v] += std::min(share, 1.0) * (path_.x()[v] - best_[v]);
  }
  report_.chosen = step.step;
}

Result<bool> Run::walk(const std::stop_token& stop) {
  const int most =
      options_.strength ? static_cast<int>(std::ceil(*options_.strength * kMost)) : kMost;
  for (auto done = static_cast<int>(report_.path.size()); done < most; ++done) {
    if (!options_.strength && done > std::max(least_step_, kEarliestLeast) + kPatience) break;
    const Result<bool> stepped = step(stop);
    if (!stepped) return stepped.error();
  }
  report_.strength = options_.strength.value_or(static_cast<double>(report_.chosen) / kMost);
  return true;
}

/// A plain low pass is the better estimate of a surface without any edges.
void Run::try_low_passes() {
  double least = cross_validation(best_outcome_, best_outcome_.freedom);
  for (LowPass& low : low_passes(stencils_, held_, path_.start(), team_)) {
    const Outcome outcome = path_.judge(low.x);
    const double gcv = cross_validation(outcome, outcome.freedom);
    if (!(gcv < least)) continue;
    least = gcv;
    best_ = std::move(low.x);
    report_.pass_band = low.pass_band;
    report_.chosen = 0;
    report_.strength = 0.0;
  }
}

std::vector<Vec3> Run::positions() const {
  std::vector<Vec3> out = mesh_.positions();
  for (std::size_t slot = 0; slot < best_.size(); ++slot) {
    if (held_[slot] == 0) {
      out[stencils_.vertex_of_slot()[slot]] = best_[slot].head<3>() * mean_edge_;
    }
  }
  return out;
}

Result<FoundNoise> Run::look(const std::stop_token& stop) {
  return find_kind(stop);
}

Result<VariationalResult> Run::run(const std::stop_token& stop) {
  VariationalResult result;
  if (options_.strength && *options_.strength <= 0.0) {
    restart(analysis_.white());
    result.positions = mesh_.positions();
    result.report.noise = sigma();
    return result;
  }
  const Result<FoundNoise> kind = find_kind(stop);
  if (!kind) return kind.error();
  report_.kind = *kind;
  report_.noise = sigma();
  if (*kind == FoundNoise::none) {
    report_.path.clear();
    report_.chosen = 0;
    report_.notes.emplace_back(
        "No noise was found, so the surface stays as it is; give a strength to smooth it all the "
        "same.");
    result.positions = mesh_.positions();
    result.report = std::move(report_);
    return result;
  }
  const Result<bool> done = walk(stop);
  if (!done) return done.error();
  if (!options_.strength && options_.surface != SurfaceKind::sharp) try_low_passes();
  result.positions = positions();
  mend_folds(mesh_, held_of_vertex_, result.positions);
  result.report = std::move(report_);
  return result;
}

}  // namespace

Result<VariationalResult> denoise_variational(
    const TriangleMesh& mesh, std::span<const unsigned char> held,
    const VariationalOptions& options, const std::function<void(const VariationalStep&)>& observer,
    std::stop_token stop) {
  return Run(mesh, held, options, observer).run(stop);
}

VariationalReport find_variational_noise(const TriangleMesh& mesh, unsigned threads) {
  const std::vector<unsigned char> held(mesh.vertex_count());
  VariationalOptions options;
  options.threads = threads;
  Run run(mesh, held, options, {});
  VariationalReport report;
  const Result<FoundNoise> kind = run.look({});
  // Where the look itself diverges the run will say so: such a surface is not clean.
  report.kind = kind ? *kind : FoundNoise::white;
  report.noise = run.sigma();
  return report;
}

}  // namespace fairway
