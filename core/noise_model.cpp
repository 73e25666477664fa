// Size, place and colour of the noise, each by comparison with noise that is known.

#include "core/noise_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.h"
#include "core/seeded_random.h"

namespace fairway {
namespace {

constexpr std::uint64_t kSizeSeed = 1;
constexpr std::uint64_t kProbeSeed = 20040901;
constexpr int kLocalPasses = 20;
constexpr int kScalePasses = 60;
constexpr double kLargestScale = 6.0;
constexpr std::array<int, NoiseAnalysis::kBands - 1> kPasses = {1, 2, 4, 8};
/// The bands' ratios of a spectrum that levels off become smaller: each logarithm is at most this
/// part of the one before. What grows faster is the shape of the surface.
constexpr std::array<double, NoiseAnalysis::kBands> kGrowth = {0.0, 0.0, 0.0, 1.0, 0.7};
constexpr double kDecileDistance = 2.563;  // between the deciles of the standard normal

std::vector<double> squares(std::span<const double> values) {
  std::vector<double> out(values.begin(), values.end());
  for (double& v : out) v *= v;
  return out;
}

}  // namespace

NoiseAnalysis::NoiseAnalysis(const EdgeStencils& mesh, std::span<const Vec3> positions,
                             std::span<const Vec3> normals)
    : mesh_(mesh),
      positions_(positions.begin(), positions.end()),
      normals_(normals.begin(), normals.end()) {}

std::vector<double> NoiseAnalysis::ring_means(std::span<const double> values) const {
  std::vector<double> out(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    const std::span<const Index> ring = mesh_.rings()[v];
    double sum = 0.0;
    for (const Index w : ring) sum += values[w];
    out[v] = ring.empty() ? values[v] : sum / static_cast<double>(ring.size());
  }
  return out;
}

std::vector<double> NoiseAnalysis::averaged(std::vector<double> values, int passes) const {
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<double> means = ring_means(values);
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = 0.5 * (values[v] + means[v]);
  }
  return values;
}

std::array<std::vector<double>, NoiseAnalysis::kBands> NoiseAnalysis::bands(
    std::span<const double> values) const {
  std::array<std::vector<double>, kBands> out;
  std::vector<double> rest(values.begin(), values.end());
  int passes = 0;
  for (std::size_t j = 0; j + 1 < kBands; ++j) {
    std::vector<double> smoother = averaged(rest, kPasses[j] - passes);
    for (std::size_t v = 0; v < rest.size(); ++v) rest[v] -= smoother[v];
    out[j] = std::exchange(rest, std::move(smoother));
    passes = kPasses[j];
  }
  out.back() = std::move(rest);
  return out;
}

std::vector<double> NoiseAnalysis::first_band(std::span<const double> values) const {
  std::vector<double> out(values.begin(), values.end());
  const std::vector<double> smoother = averaged(out, 1);
  for (std::size_t v = 0; v < out.size(); ++v) out[v] -= smoother[v];
  return out;
}

double NoiseAnalysis::median_of_inner(std::span<const double> values) const {
  std::vector<double> inner;
  inner.reserve(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (mesh_.boundary()[v] == 0) inner.push_back(values[v]);
  }
  return median(inner);
}

double NoiseAnalysis::local_power(std::span<const double> values) const {
  return median_of_inner(averaged(squares(values), kLocalPasses));
}

/// Median of |((I − W)⁴ field)·N|.
double NoiseAnalysis::median_of_fourth(std::vector<Vec3> field) const {
  std::vector<Vec3> next(field.size());
  for (int pass = 0; pass < 4; ++pass) {
    for (std::size_t v = 0; v < field.size(); ++v) {
      const std::span<const Index> ring = mesh_.rings()[v];
      Vec3 sum = Vec3::Zero();
      for (const Index w : ring) sum += field[w];
      next[v] = field[v] - sum / static_cast<double>(std::max<std::size_t>(ring.size(), 1));
    }
    field.swap(next);
  }
  std::vector<double> values(field.size());
  for (std::size_t v = 0; v < field.size(); ++v) values[v] = std::abs(field[v].dot(normals_[v]));
  return median_of_inner(values);
}

/// σ: what four differences leave of the positions over what they leave of noise of size 1.
double NoiseAnalysis::sigma_of(std::span<const double> unit_noise) const {
  std::vector<Vec3> field(normals_);
  for (std::size_t v = 0; v < field.size(); ++v) field[v] *= unit_noise[v];
  const double unit = median_of_fourth(std::move(field));
  return unit > 0.0 ? median_of_fourth(positions_) / unit : 0.0;
}

NoiseModel NoiseAnalysis::white() const {
  SeededRandom size(kSizeSeed);
  SeededRandom sign(kProbeSeed);
  NoiseModel model;
  model.scale.assign(positions_.size(), 1.0);
  std::vector<double> unit(positions_.size());
  for (double& u : unit) u = size.normal();
  model.probe.resize(positions_.size());
  for (double& b : model.probe) b = sign.sign();
  model.sigma = sigma_of(unit);
  return model;
}

NoiseModel NoiseAnalysis::coloured(const Bands& colour, std::vector<double> scale) const {
  SeededRandom random(kProbeSeed);
  std::vector<double> white(positions_.size());
  for (double& b : white) b = random.sign();
  const auto parts = bands(white);
  NoiseModel model;
  model.probe.assign(white.size(), 0.0);
  double power = 0.0;
  for (std::size_t v = 0; v < white.size(); ++v) {
    for (std::size_t j = 0; j < kBands; ++j) model.probe[v] += colour[j] * parts[j][v];
    power += model.probe[v] * model.probe[v];
  }
  const double deviation = std::sqrt(power / static_cast<double>(white.size()));
  for (std::size_t v = 0; v < white.size(); ++v) model.probe[v] *= scale[v] / deviation;
  model.scale = std::move(scale);
  model.sigma = sigma_of(model.probe);
  return model;
}

NoiseAnalysis::Bands NoiseAnalysis::better_colour(const Bands& before, const NoiseResidue& left,
                                                  std::span<const double> scale) const {
  NoiseResidue even = left;
  for (std::size_t v = 0; v < scale.size(); ++v) {
    even.noise[v] /= scale[v];
    even.probe[v] /= scale[v];
  }
  const auto noise = bands(even.noise);
  const auto probe = bands(even.probe);
  Bands colour = before;
  double first = 1.0;
  for (std::size_t j = 0; j < kBands; ++j) {
    const double known = local_power(probe[j]);
    const double ratio = known > 0.0 ? std::sqrt(local_power(noise[j]) / known) : 1.0;
    if (j == 0) first = ratio > 0.0 ? ratio : 1.0;
    colour[j] *= ratio / first;
    if (j > 0) colour[j] = std::max(colour[j], colour[j - 1]);
    if (kGrowth[j] > 0.0) {
      const double most = std::pow(colour[j - 1] / colour[j - 2], kGrowth[j]);
      colour[j] = std::min(colour[j], colour[j - 1] * most);
    }
  }
  return colour;
}

double NoiseAnalysis::correlation(const NoiseResidue& left) const {
  const auto of = [this](std::span<const double> d) {
    std::vector<double> product = ring_means(d);
    for (std::size_t v = 0; v < d.size(); ++v) product[v] *= d[v];
    product = averaged(std::move(product), kLocalPasses);
    const std::vector<double> power = averaged(squares(d), kLocalPasses);
    for (std::size_t v = 0; v < d.size(); ++v) {
      product[v] = power[v] > 0.0 ? product[v] / power[v] : 0.0;
    }
    return median_of_inner(product);
  };
  return of(left.noise) - of(left.probe);
}

double NoiseAnalysis::evenness(const NoiseResidue& left) const {
  const auto of = [this](std::span<const double> d) {
    std::vector<double> band = first_band(d);
    double power = 0.0;
    for (double& b : band) {
      power += b * b;
      b = std::abs(b);
    }
    const double deviation = std::sqrt(power / static_cast<double>(band.size()));
    return deviation > 0.0 ? median_of_inner(band) / deviation : 0.0;
  };
  const double known = of(left.probe);
  return known > 0.0 ? of(left.noise) / known : 0.0;
}

std::vector<double> NoiseAnalysis::variance_ratio(const NoiseResidue& left, int passes) const {
  std::vector<double> ratio = averaged(squares(first_band(left.noise)), passes);
  const std::vector<double> known = averaged(squares(first_band(left.probe)), passes);
  for (std::size_t v = 0; v < ratio.size(); ++v) {
    ratio[v] = known[v] > 0.0 ? ratio[v] / known[v] : 0.0;
  }
  return ratio;
}

double NoiseAnalysis::unevenness(const NoiseResidue& left) const {
  const std::vector<double> ratio = variance_ratio(left, kLocalPasses);
  std::vector<double> logs;
  for (std::size_t v = 0; v < ratio.size(); ++v) {
    if (mesh_.boundary()[v] == 0 && ratio[v] > 0.0) logs.push_back(std::log(ratio[v]));
  }
  if (logs.size() < 10) return 0.0;
  const auto decile = [&logs](std::size_t tenths) {
    const auto at = logs.begin() + static_cast<std::ptrdiff_t>(logs.size() * tenths / 10);
    std::nth_element(logs.begin(), at, logs.end());
    return *at;
  };
  const double low = decile(1);
  return (decile(9) - low) / kDecileDistance;
}

std::vector<double> NoiseAnalysis::local_scale(const NoiseResidue& left) const {
  std::vector<double> scale = variance_ratio(left, kScalePasses);
  std::vector<double> ordered;
  for (const double s : scale) {
    if (s > 0.0) ordered.push_back(s);
  }
  const double middle = median(ordered);
  for (double& s : scale) {
    s = middle > 0.0 ? std::clamp(std::sqrt(s / middle), 1.0 / kLargestScale, kLargestScale) : 1.0;
  }
  return scale;
}

}  // namespace fairway
