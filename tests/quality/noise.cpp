// Noise as authors add it and as depth sensors have it.

#include "tests/quality/noise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <set>
#include <utility>

#include "core/seeded_random.h"

namespace fairway::quality {
namespace {

constexpr auto kKinds = std::to_array<std::string_view>({"n", "r", "i", "s", "d", "q", "o"});
const Vec3 kSight = Vec3(0.3, 0.2, 1.0).normalized();

std::set<std::pair<Index, Index>> edges_of(const IndexedMesh& mesh) {
  std::set<std::pair<Index, Index>> edges;
  for (const Triangle& f : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(f[k], f[(k + 1) % 3]));
  }
  return edges;
}

double mean_edge(const IndexedMesh& mesh, const std::set<std::pair<Index, Index>>& edges) {
  double sum = 0.0;
  for (const auto& [a, b] : edges) sum += (mesh.positions[a] - mesh.positions[b]).norm();
  return sum / static_cast<double>(std::max<std::size_t>(edges.size(), 1));
}

/// Area-weighted.
std::vector<Vec3> vertex_normals(const IndexedMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const Triangle& f : mesh.triangles) {
    const Vec3& a = mesh.positions[f[0]];
    const Vec3 normal = (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a);
    for (const Index v : f) normals[v] += normal;
  }
  for (Vec3& n : normals) {
    if (n.norm() > 0.0) n.normalize();
  }
  return normals;
}

void scale_to_unit_variance(std::vector<double>& values) {
  double power = 0.0;
  for (const double v : values) power += v * v;
  const double deviation = std::sqrt(power / static_cast<double>(values.size()));
  for (double& v : values) v /= deviation;
}

/// White noise averaged once, half by half, with the mean over the ring; unit variance.
std::vector<double> smooth_noise(const std::set<std::pair<Index, Index>>& edges, std::size_t count,
                                 SeededRandom& random) {
  std::vector<double> white(count);
  for (double& v : white) v = random.normal();
  std::vector<double> sum(count, 0.0);
  std::vector<double> valence(count, 0.0);
  for (const auto& [a, b] : edges) {
    sum[a] += white[b];
    sum[b] += white[a];
    ++valence[a];
    ++valence[b];
  }
  for (std::size_t v = 0; v < count; ++v) {
    if (valence[v] > 0.0) white[v] = 0.5 * (white[v] + sum[v] / valence[v]);
  }
  scale_to_unit_variance(white);
  return white;
}

/// A sensor's image: noise per pixel of one mean edge, averaged along lines twice, across once.
class DepthImage {
 public:
  DepthImage(double pixel, SeededRandom& random)
      : pixel_(pixel), across_(kSight.unitOrthogonal()), along_(across_.cross(kSight)) {
    for (double& v : values_) v = random.normal();
    for (const std::size_t step : {std::size_t{1}, std::size_t{1}, kSide}) {
      std::vector<double> next(values_.size());
      for (std::size_t i = 0; i < next.size(); ++i) {
        const std::size_t before = (i + values_.size() - step) % values_.size();
        const std::size_t after = (i + step) % values_.size();
        next[i] = 0.25 * values_[before] + 0.5 * values_[i] + 0.25 * values_[after];
      }
      values_.swap(next);
    }
    scale_to_unit_variance(values_);
  }

  double at(const Vec3& p) const {
    const auto cell = [this](double x) {
      return static_cast<std::size_t>(std::llround(x / pixel_) + (1 << 20)) % kSide;
    };
    return values_[cell(p.dot(across_)) * kSide + cell(p.dot(along_))];
  }

 private:
  static constexpr std::size_t kSide = 1024;
  double pixel_;
  Vec3 across_, along_;
  std::vector<double> values_ = std::vector<double>(kSide * kSide);
};

struct Clean {
  const IndexedMesh& mesh;
  std::vector<Vec3> normals;
  std::set<std::pair<Index, Index>> edges;
  double edge = 0.0;
};

/// Where each vertex goes, in units of the strength.
std::vector<Vec3> ways(const Clean& clean, char kind, double strength, SeededRandom& random) {
  const std::size_t count = clean.normals.size();
  std::vector<Vec3> out(count);
  const auto each = [&](const std::function<Vec3(std::size_t)>& way) {
    for (std::size_t v = 0; v < count; ++v) out[v] = way(v);
    return out;
  };
  if (kind == 'n') return each([&](auto v) { return Vec3(random.normal() * clean.normals[v]); });
  if (kind == 'r') {
    return each([&](auto) {
      const Vec3 direction(random.normal(), random.normal(), random.normal());
      return Vec3(random.normal() * direction.normalized());
    });
  }
  if (kind == 'i') {
    return each([&](auto v) {
      const bool hit = random.unit() < 0.2;
      const double far = random.normal();
      return Vec3((hit ? far : 0.0) * clean.normals[v]);
    });
  }
  if (kind == 's') {
    const std::vector<double> noise = smooth_noise(clean.edges, count, random);
    return each([&](auto v) { return Vec3(noise[v] * clean.normals[v]); });
  }
  const DepthImage image(clean.edge, random);
  const double step = 2.0 * strength * clean.edge;
  return each([&](auto v) {
    const Vec3& p = clean.mesh.positions[v];
    double far = image.at(p);
    if (kind == 'o' && random.unit() < 0.01) far *= 10.0;
    if (kind == 'q') {
      const double depth = p.dot(kSight) + 0.25 * far * strength * clean.edge;
      far = (std::round(depth / step) * step - p.dot(kSight)) / (strength * clean.edge);
    }
    return Vec3(far * kSight);
  });
}

}  // namespace

std::span<const std::string_view> noise_kinds() {
  return kKinds;
}

std::vector<Vec3> with_noise(const IndexedMesh& clean, const std::string& noise,
                             std::uint64_t seed) {
  const double strength = std::atof(noise.c_str() + 1);
  Clean facts{clean, vertex_normals(clean), edges_of(clean), 0.0};
  facts.edge = mean_edge(clean, facts.edges);
  SeededRandom random(seed * 1000003 + static_cast<std::uint64_t>(noise[0]) * 7919 +
                      static_cast<std::uint64_t>(std::llround(strength * 1000.0)));
  std::vector<Vec3> out = clean.positions;
  if (strength <= 0.0) return out;
  const std::vector<Vec3> moves = ways(facts, noise[0], strength, random);
  for (std::size_t v = 0; v < out.size(); ++v) {
    out[v] += strength * facts.edge * moves[v];
    out[v] = out[v].cast<float>().cast<double>();
  }
  return out;
}

}  // namespace fairway::quality
