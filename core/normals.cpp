// Vertex normals after a mesh moved, with the hard edges it had.

#include "core/normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace fairway {
namespace {

// Two old normals closer than 0.1° are one: quantised normals of one direction differ by less.
constexpr double kSameNormal = 0.9999984769;

/// Vertices by place, ascending in each.
std::vector<Index> sorted_by_place(std::span<const Index> place) {
  std::vector<Index> end(place.empty() ? 0 : *std::max_element(place.begin(), place.end()) + 1);
  for (const Index p : place) ++end[p];
  Index sum = 0;
  for (Index& e : end) sum = std::exchange(e, sum) + sum;
  std::vector<Index> order(place.size());
  for (Index v = 0; v < place.size(); ++v) order[end[place[v]]++] = v;
  return order;
}

/// Group number per vertex: vertices of one place with the same old normal. Within a place each
/// vertex is compared with the first of each group so far, at most kMostGroups of them, so that a
/// place with very many normals stays linear (beyond it, vertices keep normals of their own).
std::vector<Index> smoothing_groups(std::span<const Index> place, std::span<const Vec3> old) {
  constexpr std::size_t kMostGroups = 64;
  const std::vector<Index> order = sorted_by_place(place);
  std::vector<Index> group(place.size());
  std::vector<Index> leaders;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index v = order[i];
    if (i == 0 || place[order[i - 1]] != place[v]) leaders.clear();
    const auto same = std::find_if(leaders.begin(), leaders.end(), [&](Index leader) {
      return old[leader] == old[v] || old[leader].dot(old[v]) > kSameNormal;
    });
    group[v] = same == leaders.end() ? v : *same;
    if (same == leaders.end() && leaders.size() < kMostGroups) leaders.push_back(v);
  }
  return group;
}

}  // namespace

std::vector<Vec3> keep_split_normals(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles,
                                     std::span<const Index> place_of_vertex,
                                     std::span<const Vec3> old_normals) {
  std::vector<Vec3> unit(old_normals.begin(), old_normals.end());
  for (Vec3& n : unit) n.normalize();
  const std::vector<Index> group = smoothing_groups(place_of_vertex, unit);
  std::vector<Vec3> sums(unit.size(), Vec3::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vec3 twice_area = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const Index v : {a, b, c}) sums[group[v]] += twice_area;
  }
  std::vector<Vec3> out(old_normals.begin(), old_normals.end());
  for (std::size_t v = 0; v < out.size(); ++v) {
    const double length = sums[group[v]].norm();
    if (length > 0.0 && std::isfinite(length)) out[v] = sums[group[v]] / length;
  }
  return out;
}

}  // namespace fairway
