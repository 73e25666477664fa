#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/edge_stencils.h"
#include "core/thread_team.h"

namespace fairway {

/// Three coordinates and the probe.
using Vec4 = Eigen::Vector4d;
using Four = Eigen::Array4f;

/// The linear system of an iterate, C + μ DᵀWD + (α/4) EᵀE over the free slots: rows over rings and
/// the opposite ends, scaled to a unit diagonal, solved for four right-hand sides at once by
/// conjugate gradients. Corrections are in single precision, what they correct is in double.
class StencilSystem {
 public:
  /// `held`: 1 per slot that does not move.
  StencilSystem(const EdgeStencils& mesh, std::span<const unsigned char> held, ThreadTeam& team);

  /// Starts an assembly with the diagonal C, per slot.
  void begin(std::span<const double> data);
  /// Adds `bend` c cᵀ + `fair` e eᵀ for one stencil, e = (1, 1, −1, −1).
  void add(std::size_t stencil, const std::array<float, 4>& c, float bend, float fair);

  struct Goal {
    double coordinates = 0.0;  ///< rᵗ M⁻¹ r that the three coordinates together are to reach
    double probe = 0.0;
    int most_iterations = 0;
  };
  /// Moves `x` by the solution for the residual `r`, both per slot. Returns the iterations done.
  int correct(std::span<const Vec4> r, const Goal& goal, std::span<Vec4> x);

 private:
  void finish();
  Eigen::Vector4d search();
  Eigen::Vector4d advance(const Four& length);
  Eigen::Vector4d start(std::span<const Vec4> r);

  const EdgeStencils& mesh_;
  const std::vector<unsigned char> held_;
  ThreadTeam& team_;
  // Rows: entries of slot v are offsets_[v] … offsets_[v + 1].
  std::vector<Index> offsets_, columns_;
  std::vector<float> entries_;
  std::vector<std::array<Index, 2>> places_of_edge_;     // where p–q and q–p are in the rows
  std::vector<std::array<Index, 2>> places_of_stencil_;  // o0–o1 and back
  std::vector<float> edge_values_, opposite_values_, diagonal_, scale_;
  std::vector<Four> x_, r_, direction_, image_;
  std::vector<Eigen::Vector4d> parts_;  // per range
};

}  // namespace fairway
