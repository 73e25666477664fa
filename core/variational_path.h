#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/edge_stencils.h"
#include "core/edge_target.h"
#include "core/mesh.h"
#include "core/noise_model.h"
#include "core/stencil_system.h"
#include "core/thread_team.h"

namespace fairway {

/// One minimisation after the other, each with twice the weight of the edges. All in slots and in
/// mean edges.
class VariationalPath {
 public:
  struct Numbers {
    double least_angle = 0.0;  ///< of λ, radians
  };

  /// `positions`, `normals`, `held`: per slot.
  VariationalPath(const EdgeStencils& mesh, std::span<const Vec3> positions,
                  std::span<const Vec3> normals, std::span<const unsigned char> held,
                  const Numbers& numbers, ThreadTeam& team);

  /// Back to the start, for noise of this kind.
  void restart(NoiseModel noise);
  const NoiseModel& noise() const { return noise_; }

  /// What an iterate came to.
  struct Outcome {
    double mu = 0.0;
    double lambda = 0.0;  ///< at the median height, radians
    int solver_iterations = 0;
    bool finite = true;
    double misfit = 0.0;   ///< mean of (d / scale)² over free slots
    double freedom = 0.0;  ///< f
    double rms = 0.0;      ///< of d
  };
  /// The next minimum; `number` counts from 1.
  Outcome iterate(int number);

  NoiseResidue residue() const;
  const std::vector<Vec4>& x() const { return x_; }
  const std::vector<Vec4>& start() const { return start_; }
  /// Misfit and freedom of any other estimate of the start, with its probe.
  Outcome judge(std::span<const Vec4> x) const;

 private:
  void measure_faces();
  void measure_stencil(std::size_t number);
  double weigh();
  int solve(double mu);

  const EdgeStencils& mesh_;
  const std::vector<Vec3> normals_;
  const std::vector<unsigned char> held_;
  const Numbers numbers_;
  ThreadTeam& team_;
  std::size_t free_ = 0;
  NoiseModel noise_;
  std::vector<Vec4> start_, x_, residual_;
  std::vector<double> data_;  // c_v
  std::vector<Four> face_normals_;
  std::vector<float> face_areas_;
  std::vector<float> residual_bends_;
  std::vector<EdgeState> states_;
  EdgeTargets targets_;
  StencilSystem system_;
};

}  // namespace fairway
