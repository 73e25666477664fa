#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/edge_stencils.h"
#include "core/stencil_system.h"
#include "core/thread_team.h"

namespace fairway {

/// Of a stencil in one iterate. Lengths are in mean edges.
struct EdgeState {
  std::array<float, 4> c{};    ///< of D_e x = Σ c_k y_k; they add up to 0
  Four sag = Four::Zero();     ///< D_e x
  Four across = Four::Zero();  ///< t, and w_e (a0 + a1) / 3
  Four normal = Four::Zero();  ///< N_e and 0
  Four target = Four::Zero();  ///< δ_e N_e, and the probe's δ_e
  float height = 0.0F;         ///< h_e
  float weight = 0.0F;         ///< w_e
  float bend_target = 0.0F;    ///< τ_e, radians
  float strength = 0.0F;       ///< of the curvature prescribed: h_e⁴ |S̄_e|²
  float per_sag = 0.0F;        ///< w_e l / h_e
};

/// D_e of a field, as differences from p: large coordinates cost no digits.
inline Four sag(const EdgeStencil& stencil, const EdgeState& state, std::span<const Vec4> x) {
  const auto& [p, q, o0, o1] = stencil.points;
  const Vec4 d = static_cast<double>(state.c[1]) * (x[q] - x[p]) +
                 static_cast<double>(state.c[2]) * (x[o0] - x[p]) +
                 static_cast<double>(state.c[3]) * (x[o1] - x[p]);
  return d.cast<float>().array();
}

/// ⟨a, b⟩ of the three coordinates.
inline float dot3(const Four& a, const Four& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The prescribed curvature of an iterate: shape operators of edges, averaged over faces with the
/// weights as barriers, and the sag they give every edge. Kept between iterates for its memory.
class EdgeTargets {
 public:
  EdgeTargets(const EdgeStencils& mesh, ThreadTeam& team);

  /// Sets all members of `states` from c, sag, normal, height and weight on. `areas`: of faces;
  /// `passes`: of averaging; `sigma`: of the noise, which the probe stands for.
  void prescribe(std::span<const Vec4> x, std::span<const float> areas, int passes, double sigma,
                 std::span<EdgeState> states);

 private:
  /// xx, yy, zz and area; xy, xz, yz and 0; the same of the probe, without the area.
  using Shape = Eigen::Array<float, 16, 1>;
  using Share = Eigen::Array2f;

  void turn(std::size_t stencil, std::span<const Vec4> x, std::span<const float> areas,
            EdgeState& state) const;
  Shape shape_of_face(std::size_t face, std::span<const EdgeState> states) const;
  double aim(std::size_t stencil, std::span<const Vec4> x, EdgeState& state) const;
  void shrink(double noise, std::span<EdgeState> states);
  template <class Field>
  void average(std::vector<Field>& field, std::vector<Field>& next, int passes);

  const EdgeStencils& mesh_;
  ThreadTeam& team_;
  std::vector<Eigen::Array4f> weights_;  // of a face's three stencils, over 4
  std::vector<Shape> shapes_, next_shapes_;
  std::vector<Share> shares_, next_shares_;
  std::vector<double> parts_;
};

}  // namespace fairway
