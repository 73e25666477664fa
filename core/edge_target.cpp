// What every edge should bend by, from what the surface around it bends by.

#include "core/edge_target.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fairway {
namespace {

constexpr std::size_t kRange = 2048;
constexpr int kShrinkagePasses = 20;
constexpr double kShrinkageCap = 300.0;
constexpr double kShrinkage = 3.0;
constexpr float kLeastHeight = 0.05F;  // of the edge's length
// Averages divide by four what barriers keep from its neighbours: below this, digits are lost.
constexpr float kLeastShare = 1e-30F;

using Sym = Eigen::Array<float, 8, 1>;  // xx, yy, zz, –, xy, xz, yz, –

/// yᵗ S y.
float quadratic(const Sym& s, const Sym& products) {
  const Sym terms = s * products;
  return terms[0] + terms[1] + terms[2] + 2.0F * (terms[4] + terms[5] + terms[6]);
}

Sym products(const Eigen::Vector3f& y) {
  Sym out;
  out << y.x() * y.x(), y.y() * y.y(), y.z() * y.z(), 0.0F, y.x() * y.y(), y.x() * y.z(),
      y.y() * y.z(), 0.0F;
  return out;
}

float squared_norm(const Sym& s) {
  return quadratic(s, s);
}

}  // namespace

EdgeTargets::EdgeTargets(const EdgeStencils& mesh, ThreadTeam& team)
    : mesh_(mesh),
      team_(team),
      weights_(mesh.faces().size()),
      shapes_(mesh.faces().size()),
      next_shapes_(mesh.faces().size()),
      shares_(mesh.faces().size()),
      next_shares_(mesh.faces().size()),
      parts_((mesh.stencils().size() + kRange - 1) / kRange) {}

/// F_f ← (F_f + Σ w_e F_g) / 4 over the three neighbours: features are barriers.
template <class Field>
void EdgeTargets::average(std::vector<Field>& field, std::vector<Field>& next, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    team_.for_ranges(field.size(), kRange, [&](std::size_t first, std::size_t last) {
      for (std::size_t f = first; f < last; ++f) {
        const auto& [a, b, c] = mesh_.neighbours_of_face()[f];
        const Eigen::Array4f& w = weights_[f];
        next[f] = 0.25F * field[f] + w[0] * field[a] + w[1] * field[b] + w[2] * field[c];
      }
    });
    field.swap(next);
  }
}

/// t and what it is multiplied by.
void EdgeTargets::turn(std::size_t stencil, std::span<const Vec4> x, std::span<const float> areas,
                       EdgeState& state) const {
  const EdgeStencil& s = mesh_.stencils()[stencil];
  const Eigen::Vector3f along = (x[s.points[1]] - x[s.points[0]]).head<3>().cast<float>();
  const Eigen::Vector3f across = along.cross(state.normal.head<3>().matrix());
  const float length = along.norm();
  const float size = across.norm();
  state.across.setZero();
  state.per_sag = 0.0F;
  if (!(size > 0.0F)) return;
  state.across.head<3>() = across.array() / size;
  state.across[3] = state.weight * (areas[s.faces[0]] + areas[s.faces[1]]) / 3.0F;
  state.per_sag = state.weight * length / std::max(state.height, kLeastHeight * length);
}

/// Σ w_e (l s_e / h_e) t tᵗ and Σ w_e (a0 + a1) / 3 over the three edges.
EdgeTargets::Shape EdgeTargets::shape_of_face(std::size_t face,
                                              std::span<const EdgeState> states) const {
  Shape shape = Shape::Zero();
  for (const Index s : mesh_.stencils_of_face()[face]) {
    if (s == kNoIndex) continue;
    const EdgeState& state = states[s];
    const Sym tensor = products(state.across.head<3>().matrix());
    shape.head<8>() += state.per_sag * dot3(state.sag, state.normal) * tensor;
    shape.tail<8>() += state.per_sag * state.sag[3] * tensor;
    shape[3] += state.across[3];
  }
  return shape;
}

/// δ_e from the averaged shape operators; returns h_e⁴ |S̄_e|² of the probe.
double EdgeTargets::aim(std::size_t stencil, std::span<const Vec4> x, EdgeState& state) const {
  const EdgeStencil& s = mesh_.stencils()[stencil];
  state.target.setZero();
  state.strength = 0.0F;
  const Shape both = shapes_[s.faces[0]] + shapes_[s.faces[1]];
  if (!(both[3] > kLeastShare)) return 0.0;
  const float share = 1.0F / both[3];
  Sym surface = both.head<8>() * share;
  surface[3] = 0.0F;
  const Sym probe = both.tail<8>() * share;
  // Σ c_k y_k y_kᵗ about the middle of the edge, where y_p = −y_q.
  const auto& [p, q, o0, o1] = s.points;
  const Vec4 middle = 0.5 * (x[p] + x[q]);
  const auto from_middle = [&](Index v) {
    return products((x[v] - middle).head<3>().cast<float>());
  };
  const Sym stencil_products = (state.c[0] + state.c[1]) * from_middle(q) +
                               state.c[2] * from_middle(o0) + state.c[3] * from_middle(o1);
  state.target = 0.5F * quadratic(surface, stencil_products) * state.normal;
  state.target[3] = 0.5F * quadratic(probe, stencil_products);
  const float h2 = state.height * state.height;
  state.strength = h2 * h2 * squared_norm(surface);
  return static_cast<double>(h2 * h2 * squared_norm(probe));
}

/// η_e: curvature that noise alone would show as often is none.
void EdgeTargets::shrink(double noise, std::span<EdgeState> states) {
  const auto cap = static_cast<float>(kShrinkageCap * noise);
  team_.for_ranges(shares_.size(), kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      shares_[f].setZero();
      for (const Index s : mesh_.stencils_of_face()[f]) {
        if (s != kNoIndex) shares_[f] += Share(std::min(states[s].strength, cap), 1.0F);
      }
    }
  });
  average(shares_, next_shares_, kShrinkagePasses);
  team_.for_ranges(states.size(), kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      EdgeState& state = states[s];
      const EdgeStencil& stencil = mesh_.stencils()[s];
      const Share both = shares_[stencil.faces[0]] + shares_[stencil.faces[1]];
      const double mean = both[1] > 0.0F ? static_cast<double>(both[0] / both[1]) : 0.0;
      const double eta = mean > 0.0 ? std::max(0.0, 1.0 - kShrinkage * noise / mean) : 0.0;
      state.target *= static_cast<float>(eta);
      const float bend =
          state.height > 0.0F ? dot3(state.target, state.normal) / state.height : 0.0F;
      state.bend_target = std::clamp(bend, -1.0F, 1.0F);
    }
  });
}

void EdgeTargets::prescribe(std::span<const Vec4> x, std::span<const float> areas, int passes,
                            double sigma, std::span<EdgeState> states) {
  team_.for_ranges(states.size(), kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) turn(s, x, areas, states[s]);
  });
  team_.for_ranges(shapes_.size(), kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      shapes_[f] = shape_of_face(f, states);
      weights_[f].setZero();
      for (std::size_t k = 0; k < 3; ++k) {
        const Index s = mesh_.stencils_of_face()[f][k];
        if (s != kNoIndex) weights_[f][static_cast<Eigen::Index>(k)] = 0.25F * states[s].weight;
      }
    }
  });
  average(shapes_, next_shapes_, passes);
  team_.for_ranges(states.size(), kRange, [&](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t s = first; s < last; ++s) sum += aim(s, x, states[s]);
    parts_[first / kRange] = sum;
  });
  double of_probe = 0.0;
  for (const double part : parts_) of_probe += part;
  shrink(sigma * sigma * of_probe / static_cast<double>(states.size()), states);
}

}  // namespace fairway
