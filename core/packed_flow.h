#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/execution.h"
#include "core/flow_options.h"
#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// The explicit flows, eqs. (8), (10), (11), on packed kernels. Lengths inside are in mean edges L,
/// so the same numbers come out for a mesh in metres or millimetres.
class PackedFlow {
 public:
  /// `positions`: one per surface vertex; `mean_edge`: L; `held`: vertices that do not move.
  static std::unique_ptr<PackedFlow> create(const TriangleMesh& mesh,
                                            std::span<const Vec3> positions, double mean_edge,
                                            std::span<const unsigned char> held,
                                            const FlowOptions& options, const Execution& execution);
  virtual ~PackedFlow() = default;

  /// Bends of edges now: robust_bend (radians), and whether one is bent by more than 120°.
  struct Bends {
    double robust = 0.0;
    bool folded = false;
  };
  /// `sampled`: of an even choice of about 4 000 vertices, where there are more.
  virtual Bends bends(bool sampled) = 0;
  /// See curvature_roughness(); over the barycentric instead of the mixed area.
  virtual double roughness() = 0;
  /// Remembers positions and normals for displacement().
  virtual void mark_start() = 0;
  /// What one step came to.
  struct Outcome {
    bool in_bounds = true;   ///< false: a position is not finite or a coordinate beyond the bound
    bool finite = true;      ///< false: it is the former
    bool solved = true;      ///< false: the linear system was not solved, however small the step
    double time_step = 0.0;  ///< as done: halved as often as the solver asked for
    int solver_iterations = 0;
    double solver_residual = 0.0;
  };
  /// One step; `bound` of coordinates in L. Nothing has moved where it is out of bounds or
  /// unsolved.
  virtual Outcome step(double lambda, double time_step, double bound) = 0;
  /// Vertices that the last step took for features.
  virtual std::vector<unsigned char> features() const = 0;
  /// rms displacement of the vertices that may move along the normals of the start, in L; of an
  /// even choice of about 4 000 vertices, where there are more.
  virtual double displacement() = 0;
  /// Memory of the kernels beyond positions and topology, bytes.
  virtual std::size_t kernel_bytes() const = 0;
  /// Where `start`, the positions the flow was made from, went since mark_start(); what did not
  /// move stays bit for bit.
  virtual std::vector<Vec3> positions(std::span<const Vec3> start) const = 0;
};

}  // namespace fairway
