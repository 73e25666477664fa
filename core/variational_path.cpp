// The passes of an iterate, letters as in core/EQUATIONS.md, "Variational method".

#include "core/variational_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/edge_geometry.h"
#include "core/median.h"

namespace fairway {
namespace {

constexpr std::size_t kRange = 4096;
constexpr int kFirstPower = -5;  // μ of the first iterate is 2 to this
constexpr int kSolverIterations = 60;
constexpr double kSolverTolerance = 1e-4;
constexpr double kGaussian = 0.6745;  // median of |g| of the standard normal
constexpr double kBendDeviations = 3.25;
constexpr double kTransition = 10.0;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLargestAngle = 90.0 * kDegree;
constexpr double kLeastRatio = 0.25;  // of the median height to a stencil's
constexpr double kLargestRatio = 16.0;
constexpr double kRobustDeviations = 3.0;
constexpr double kLeastData = 1e-9;
constexpr double kSmallestArea = 1e-12;

int averaging_passes(double mu) {
  return static_cast<int>(std::clamp(std::round(5.0 * std::pow(mu, 0.3)), 2.0, 30.0));
}

float norm3(const Four& a) {
  return std::sqrt(dot3(a, a));
}

}  // namespace

VariationalPath::VariationalPath(const EdgeStencils& mesh, std::span<const Vec3> positions,
                                 std::span<const Vec3> normals, std::span<const unsigned char> held,
                                 const Numbers& numbers, ThreadTeam& team)
    : mesh_(mesh),
      normals_(normals.begin(), normals.end()),
      held_(held.begin(), held.end()),
      numbers_(numbers),
      team_(team),
      free_(static_cast<std::size_t>(std::count(held.begin(), held.end(), 0))),
      start_(positions.size()),
      residual_(positions.size()),
      face_normals_(mesh.faces().size()),
      face_areas_(mesh.faces().size()),
      residual_bends_(mesh.stencils().size()),
      targets_(mesh, team),
      system_(mesh, held, team) {
  for (std::size_t v = 0; v < positions.size(); ++v) start_[v] << positions[v], 0.0;
}

void VariationalPath::restart(NoiseModel noise) {
  noise_ = std::move(noise);
  data_.resize(start_.size());
  for (std::size_t v = 0; v < start_.size(); ++v) {
    start_[v][3] = held_[v] != 0 ? 0.0 : noise_.probe[v];
    data_[v] = 1.0 / (noise_.scale[v] * noise_.scale[v]);
  }
  x_ = start_;
  states_.assign(mesh_.stencils().size(), {});
}

void VariationalPath::measure_faces() {
  team_.for_ranges(mesh_.faces().size(), kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      const auto& [a, b, c] = mesh_.faces()[f];
      const Vec3 normal = (x_[b] - x_[a]).head<3>().cross((x_[c] - x_[a]).head<3>());
      const double twice = normal.norm();
      const bool present = 0.5 * twice > kSmallestArea;
      face_areas_[f] = present ? static_cast<float>(0.5 * twice) : 0.0F;
      face_normals_[f].setZero();
      if (present) face_normals_[f].head<3>() = (normal / twice).cast<float>().array();
    }
  });
}

/// a. D_e at the surface of now, and by how much its bend is not explained.
void VariationalPath::measure_stencil(std::size_t number) {
  const EdgeStencil& stencil = mesh_.stencils()[number];
  EdgeState& state = states_[number];
  const auto& [p, q, o0, o1] = stencil.points;
  const auto a0 = static_cast<double>(face_areas_[stencil.faces[0]]);
  const auto a1 = static_cast<double>(face_areas_[stencil.faces[1]]);
  const double sum = a0 + a1;
  const Vec3 along = (x_[q] - x_[p]).head<3>();
  const double l2 = along.squaredNorm();
  if (!(sum > 0.0) || !(l2 > 0.0)) {
    state = {};
    residual_bends_[number] = 0.0F;
    return;
  }
  const double t0 = (x_[o0] - x_[p]).head<3>().dot(along) / l2;
  const double t1 = (x_[o1] - x_[p]).head<3>().dot(along) / l2;
  state.c[1] = static_cast<float>(-(a1 * t0 + a0 * t1) / sum);
  state.c[2] = static_cast<float>(a1 / sum);
  state.c[3] = static_cast<float>(a0 / sum);
  state.c[0] = -(state.c[1] + state.c[2] + state.c[3]);
  state.height = static_cast<float>(2.0 * a0 * a1 / (sum * std::sqrt(l2)));
  const Four& n0 = face_normals_[stencil.faces[0]];
  const Four& n1 = face_normals_[stencil.faces[1]];
  const Four between = n0 + n1;
  const float length = norm3(between);
  state.normal = length > 0.0F ? Four(between / length) : Four(Four::Zero());
  const float half = std::min(norm3(n0 - n1) / 2.0F, 1.0F);
  state.sag = sag(stencil, state, x_);
  const float bend = std::copysign(2.0F * std::asin(half), dot3(state.sag, between));
  residual_bends_[number] = std::abs(bend - state.bend_target);
}

/// b. Weights on what the target does not explain. Returns λ at the median height.
double VariationalPath::weigh() {
  const std::size_t count = states_.size();
  team_.for_ranges(count, kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) measure_stencil(s);
  });
  std::vector<float> values(residual_bends_);
  const double b = static_cast<double>(median_and_largest(values).median) / kGaussian;
  values.resize(count);
  for (std::size_t s = 0; s < count; ++s) values[s] = states_[s].height;
  const auto middle = static_cast<double>(median_and_largest(values).median);
  team_.for_ranges(count, kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      const auto height = static_cast<double>(states_[s].height);
      const double ratio = height > 0.0 ? middle / height : kLargestRatio;
      const double scale = std::clamp(ratio, kLeastRatio, kLargestRatio);
      const double lambda = std::clamp(kBendDeviations * b * scale, numbers_.least_angle,
                                       kLargestAngle * std::clamp(scale, 1.0, 2.0));
      states_[s].weight = static_cast<float>(
          edge_weight(static_cast<double>(residual_bends_[s]), lambda, kTransition));
    }
  });
  return kBendDeviations * b;
}

/// d. The minimum, from where the last one was.
int VariationalPath::solve(double mu) {
  const double sigma = noise_.sigma;
  const double alpha = std::min(2.0, 10.0 * sigma * sigma) * std::min(1.0, 0.5 / mu);
  const auto fair = static_cast<float>(alpha / 4.0);
  system_.begin(data_);
  for (std::size_t v = 0; v < x_.size(); ++v) residual_[v] = data_[v] * (start_[v] - x_[v]);
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const EdgeStencil& stencil = mesh_.stencils()[s];
    const EdgeState& state = states_[s];
    const auto& [p, q, o0, o1] = stencil.points;
    const float weight = static_cast<float>(mu) * state.weight;
    const Vec4 bend = (weight * (state.sag - state.target)).matrix().cast<double>();
    const Vec4 uneven = 0.25 * alpha * ((x_[p] - x_[o0]) + (x_[q] - x_[o1]));
    residual_[p] -= static_cast<double>(state.c[0]) * bend + uneven;
    residual_[q] -= static_cast<double>(state.c[1]) * bend + uneven;
    residual_[o0] -= static_cast<double>(state.c[2]) * bend - uneven;
    residual_[o1] -= static_cast<double>(state.c[3]) * bend - uneven;
    system_.add(s, state.c, weight, fair);
  }
  const double small = kSolverTolerance * static_cast<double>(free_);
  return system_.correct(residual_, {small * sigma * sigma, small, kSolverIterations}, x_);
}

VariationalPath::Outcome VariationalPath::judge(std::span<const Vec4> x) const {
  Outcome out;
  double sum = 0.0;
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (held_[v] != 0) continue;
    const double weight = 1.0 / (noise_.scale[v] * noise_.scale[v]);
    const double d = (x[v] - start_[v]).head<3>().dot(normals_[v]);
    out.freedom += weight * start_[v][3] * x[v][3];
    out.misfit += weight * d * d;
    sum += d * d;
    out.finite = out.finite && x[v].allFinite();
  }
  const auto count = static_cast<double>(std::max<std::size_t>(free_, 1));
  out.freedom /= count;
  out.misfit /= count;
  out.rms = std::sqrt(sum / count);
  return out;
}

VariationalPath::Outcome VariationalPath::iterate(int number) {
  const double mu = std::exp2(number - 1 + kFirstPower);
  measure_faces();
  const double lambda = weigh();
  targets_.prescribe(x_, face_areas_, averaging_passes(mu), noise_.sigma, states_);
  const int iterations = solve(mu);
  for (std::size_t v = 0; v < x_.size(); ++v) {
    const double scale = noise_.scale[v];
    const double d = (x_[v] - start_[v]).head<3>().dot(normals_[v]);
    const double far = d / (kRobustDeviations * noise_.sigma * scale);
    data_[v] = std::max(1.0 / (scale * scale * (1.0 + far * far)), kLeastData);
  }
  Outcome out = judge(x_);
  out.mu = mu;
  out.lambda = lambda;
  out.solver_iterations = iterations;
  return out;
}

NoiseResidue VariationalPath::residue() const {
  NoiseResidue left;
  left.noise.reserve(x_.size());
  left.probe.reserve(x_.size());
  for (std::size_t v = 0; v < x_.size(); ++v) {
    left.noise.push_back((x_[v] - start_[v]).head<3>().dot(normals_[v]));
    left.probe.push_back(start_[v][3] - x_[v][3]);
  }
  return left;
}

}  // namespace fairway
