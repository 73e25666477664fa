#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/flow_kernels.h"
#include "core/flow_options.h"
#include "core/packed_mesh.h"
#include "core/system_kernels.h"
#include "core/thread_team.h"

namespace fairway {

/// How the solution of one linear system went.
struct SolverReport {
  int iterations = 0;
  double residual = 0.0;  ///< true relative residual |b − A x| / |b|, largest of the three columns;
                          ///< NaN if one of them is
  bool converged = false;
};

/// M + s K_A on a packed surface, eqs. (12), (13), in units of the mean edge: nonsymmetric, one row
/// per slot over its ring. Solved for three right-hand sides at once by BiCGSTAB with a Jacobi
/// preconditioner: rows are stored divided by their diagonal. Kept between steps for its memory.
class ImplicitSystem {
 public:
  ImplicitSystem(const PackedMesh& mesh, ThreadTeam& team, Isa isa);

  struct Numbers {
    double time_step;  ///< s; 0 leaves the mass matrix alone
    double lambda;
    double transition;
    Mass mass;
  };
  /// `positions` in L; `strong`: the edges that carry the weight w, a bit per lane and column, all
  /// others carry 1. Rows of `held` slots become those of the identity.
  void assemble(std::span<const Quad<double>> positions, std::span<const std::uint8_t> strong,
                std::span<const Index> held, const Numbers& numbers);

  /// Solves A x = b from x = 0 to a relative residual of `tolerance`; `x` is overwritten. Entries
  /// of `b` at held slots and fillers must be 0.
  SolverReport solve(std::span<const Quad<double>> b, double tolerance, int most_iterations,
                     std::vector<Quad<double>>& x);

  /// The matrix as assembled: a_pp per slot, and a_pq / a_pp per entry of the packed ring.
  std::span<const double> diagonal() const { return diagonal_; }
  std::span<const double> coefficients() const { return coefficients_; }

 private:
  using Vectors = std::vector<Quad<double>>;

  template <class Kernel>
  SolverSums sum_over(const Kernel& kernel);

  const PackedMesh& mesh_;
  ThreadTeam& team_;
  const SystemKernels& kernels_;
  std::vector<double> diagonal_;      // per slot; 1 for fillers and held slots
  std::vector<double> coefficients_;  // per ring entry, divided by the diagonal
  Vectors r_, shadow_, p_, v_, t_;    // see SolverVectors
  std::vector<SolverSums> parts_;     // per range
};

}  // namespace fairway
