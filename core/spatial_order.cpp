// What comes in no order is put in order once, so that nothing later jumps about in memory.

#include "core/spatial_order.h"

#include <algorithm>
#include <utility>

#include "core/morton_order.h"

namespace fairway {
namespace {

// Below, all of a mesh is in the cache anyway.
constexpr std::size_t kLarge = 65536;

Index least_corner(const Triangle& f) {
  return std::min({f[0], f[1], f[2]});
}

/// The number of each class along a Morton curve.
std::vector<Index> ranks(std::span<const Vec3> positions, const Weld& weld) {
  std::vector<Vec3> places;
  places.reserve(weld.count);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    // Classes are numbered by first appearance.
    if (weld.place[i] == places.size()) places.push_back(positions[i]);
  }
  const std::vector<Index> order = morton_order(places);
  std::vector<Index> rank(order.size());
  for (Index i = 0; i < order.size(); ++i) rank[order[i]] = i;
  return rank;
}

/// Stable, in linear time.
std::vector<Triangle> sorted_by_least_corner(const std::vector<Triangle>& faces,
                                             std::size_t vertex_count) {
  std::vector<Index> end(vertex_count, 0);
  for (const Triangle& f : faces) ++end[least_corner(f)];
  Index sum = 0;
  for (Index& e : end) sum = std::exchange(e, sum) + sum;
  std::vector<Triangle> out(faces.size());
  for (const Triangle& f : faces) out[end[least_corner(f)]++] = f;
  return out;
}

}  // namespace

bool in_no_order(std::span<const Triangle> faces, std::size_t vertex_count) {
  constexpr std::size_t kSamples = 1024;
  if (vertex_count < kLarge || faces.size() < 2 * kSamples) return false;
  std::size_t far = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const std::size_t f = i * (faces.size() - 1) / kSamples;
    const auto [a, b, c] = faces[f];
    const auto [d, e, g] = faces[f + 1];
    const auto [least, most] = std::minmax({a, b, c, d, e, g});
    if (most - least > vertex_count / 8) ++far;
  }
  return far > kSamples / 4;
}

void order_in_space(std::span<const Vec3> positions, Weld& weld, std::vector<Triangle>& faces) {
  const std::vector<Index> rank = ranks(positions, weld);
  for (Index& place : weld.place) place = rank[place];
  for (Triangle& f : faces) f = {rank[f[0]], rank[f[1]], rank[f[2]]};
  faces = sorted_by_least_corner(faces, weld.count);
}

}  // namespace fairway
