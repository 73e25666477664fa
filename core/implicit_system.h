#pragma once

#include <array>
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
/// preconditioner: rows are stored divided by their diagonal. Iterates in single precision, which
/// halves the memory traffic, for corrections to the true residual in double; where these stop
/// paying, in double from the start. Kept between steps for its memory.
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

  /// Solves A x = b from x = 0 to a true relative residual of `tolerance`, or, where rounding ends
  /// progress, of 10 times that; `x` is overwritten. Entries of `b` at held slots and fillers must
  /// be 0. `most_iterations` in single precision, and as many again in double where it needs them;
  /// the report counts both.
  SolverReport solve(std::span<const Quad<double>> b, double tolerance, int most_iterations,
                     std::vector<Quad<double>>& x);

  /// The matrix as assembled: a_pp per slot, and a_pq / a_pp per entry of the packed ring.
  std::span<const double> diagonal() const { return diagonal_; }
  std::span<const double> coefficients() const { return coefficients_; }

 private:
  struct Goal {
    std::span<const Quad<double>> b;
    double tolerance;
    int most_iterations;
  };
  template <class Real>
  struct Solver;

  template <class Kernel>
  SolverSums sum_over(const Kernel& kernel);
  template <class Real>
  SolverReport solve_in(const Solver<Real>& solver, const Goal& goal, std::vector<Quad<double>>& x);
  struct State;
  template <class Real>
  int iterate(const Solver<Real>& solver, State& state, int most_iterations);

  const PackedMesh& mesh_;
  ThreadTeam& team_;
  const SystemKernels& kernels_;
  // The matrix: per slot (1 for fillers and held slots), and per ring entry over its diagonal.
  std::vector<double> diagonal_, coefficients_;
  std::vector<float> rounded_diagonal_, rounded_coefficients_;
  std::array<std::vector<Quad<float>>, 6> single_;   // see SolverVectors
  std::array<std::vector<Quad<double>>, 6> double_;  // empty until a system needs them
  std::vector<SolverSums> parts_;                    // per range
};

}  // namespace fairway
