// Chebyshev series of ideal low passes, damped by a window.

#include "core/low_pass.h"

#include <array>
#include <cmath>
#include <numbers>

namespace fairway {
namespace {

constexpr std::size_t kDegree = 20;
constexpr double kFirstBand = 0.1;
constexpr int kLowPasses = 7;
constexpr std::size_t kRange = 2048;

using Series = std::array<double, kDegree + 1>;

/// Coefficients of T_i(1 − k/2) for the band [0, pass_band], k in [0, 2] an eigenvalue of I − W.
Series series(double pass_band) {
  const double angle = std::acos(1.0 - 0.5 * pass_band);
  Series c{};
  double sum = 0.0;
  for (std::size_t i = 0; i <= kDegree; ++i) {
    const auto n = static_cast<double>(i);
    const double ideal =
        i == 0 ? angle / std::numbers::pi : 2.0 * std::sin(n * angle) / (n * std::numbers::pi);
    c[i] = ideal * (0.54 + 0.46 * std::cos(n * std::numbers::pi / (kDegree + 1)));
    sum += c[i];
  }
  for (double& value : c) value /= sum;
  return c;
}

/// The mean of a slot's neighbours; on the boundary of those along it.
Vec4 ring_mean(const EdgeStencils& mesh, std::span<const Vec4> x, std::size_t v) {
  const std::span<const Index> ring = mesh.rings()[v];
  if (ring.empty()) return x[v];
  if (mesh.boundary()[v] != 0) return 0.5 * (x[ring.front()] + x[ring.back()]);
  Vec4 sum = Vec4::Zero();
  for (const Index w : ring) sum += x[w];
  return sum / static_cast<double>(ring.size());
}

}  // namespace

std::vector<LowPass> low_passes(const EdgeStencils& mesh, std::span<const unsigned char> held,
                                std::span<const Vec4> x, ThreadTeam& team) {
  std::vector<LowPass> out(kLowPasses);
  std::vector<Series> c;
  for (int j = 0; j < kLowPasses; ++j) {
    out[j].pass_band = kFirstBand * std::exp2(0.5 * j);
    out[j].x.assign(x.size(), Vec4::Zero());
    c.push_back(series(out[j].pass_band));
  }
  // Of consecutive degrees: T_{i+1} = 2 A T_i − T_{i−1}, A = I − (I − W) / 2.
  std::vector<Vec4> before(x.begin(), x.end());
  std::vector<Vec4> now(x.begin(), x.end());
  std::vector<Vec4> next(x.size());
  for (std::size_t i = 0; i <= kDegree; ++i) {
    team.for_ranges(x.size(), kRange, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) {
        for (std::size_t j = 0; j < out.size(); ++j) out[j].x[v] += c[j][i] * now[v];
        const Vec4 image = held[v] != 0 ? now[v] : Vec4(0.5 * (now[v] + ring_mean(mesh, now, v)));
        next[v] = i == 0 ? image : Vec4(2.0 * image - before[v]);
      }
    });
    before.swap(now);
    now.swap(next);
  }
  for (LowPass& low : out) {
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (held[v] != 0) low.x[v] = x[v];
    }
  }
  return out;
}

}  // namespace fairway
