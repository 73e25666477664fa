#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/edge_stencils.h"
#include "core/mesh.h"

namespace fairway {

/// What the noise of a surface is taken for. Vectors have one entry per slot.
struct NoiseModel {
  double sigma = 0.0;         ///< standard deviation along the normals, in the unit of positions
  std::vector<double> scale;  ///< of σ, local; median 1
  std::vector<double> probe;  ///< noise of this kind with σ = 1, from a fixed seed
};

/// What is left of the noise, and of the probe, after some smoothing. One entry per slot.
struct NoiseResidue {
  std::vector<double> noise;  ///< way of the slot along its normal
  std::vector<double> probe;
};

/// Estimates and statistics of noise on one surface. W is the mean over the ring, P = (I + W) / 2;
/// bands are I − P, P − P², P² − P⁴, P⁴ − P⁸, P⁸. "Local" is averaged by 20 passes of P, and
/// boundary slots are left out. Immutable.
class NoiseAnalysis {
 public:
  static constexpr std::size_t kBands = 5;
  using Bands = std::array<double, kBands>;

  /// `positions`, `normals`: per slot.
  NoiseAnalysis(const EdgeStencils& mesh, std::span<const Vec3> positions,
                std::span<const Vec3> normals);

  /// Noise of each slot by itself, everywhere as strong.
  NoiseModel white() const;
  /// Noise with local `scale` whose bands are `colour` times as strong as white noise's.
  NoiseModel coloured(const Bands& colour, std::vector<double> scale) const;
  /// Colour of `model` corrected by what it left unexplained: grows towards smooth bands only, and
  /// ever less. `before`: the colour `model` was made with.
  Bands better_colour(const Bands& before, const NoiseResidue& left,
                      std::span<const double> scale) const;

  /// How much more alike neighbours are in the noise than in the probe: median local correlation at
  /// distance one. About 0 for white noise, 0.15 and more where it is smooth or is detail.
  double correlation(const NoiseResidue& left) const;
  /// median|·| over the standard deviation in the first band, against the probe's: 1 for a normal
  /// distribution, 0.4 where few slots have all of the noise.
  double evenness(const NoiseResidue& left) const;
  /// Spread of the logarithm of the local variance against the probe's, as the standard deviation
  /// of a normal distribution. Up to 0.3 where σ is the same everywhere.
  double unevenness(const NoiseResidue& left) const;
  /// Local standard deviation against the probe's: median 1, within [1/6, 6].
  std::vector<double> local_scale(const NoiseResidue& left) const;

 private:
  std::vector<double> averaged(std::vector<double> values, int passes) const;
  std::vector<double> ring_means(std::span<const double> values) const;
  std::array<std::vector<double>, kBands> bands(std::span<const double> values) const;
  std::vector<double> first_band(std::span<const double> values) const;
  double median_of_inner(std::span<const double> values) const;
  double local_power(std::span<const double> values) const;
  std::vector<double> variance_ratio(const NoiseResidue& left, int passes) const;
  double median_of_fourth(std::vector<Vec3> field) const;
  double sigma_of(std::span<const double> unit_noise) const;

  const EdgeStencils& mesh_;
  std::vector<Vec3> positions_, normals_;
};

}  // namespace fairway
