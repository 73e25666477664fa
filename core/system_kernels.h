#pragma once

#include <cstdint>

#include "core/flow_kernels.h"
#include "core/slice.h"

namespace fairway {

// The inner loops of ImplicitSystem, compiled for several instruction sets like those of the flows:
// plain data only. A vector is a quad per slot, three columns side by side; its w is 0 throughout.

/// What the rows of M + s K_A are made of.
struct SystemNumbers {
  double time_step;  ///< s in L²; 0 leaves the mass matrix alone
  double lambda;     ///< λ in L
  double transition;
  bool full_mass;
};

/// Rows over rings, scaled to a unit diagonal: D⁻¹ A.
struct ScaledMatrix {
  const Slice* slices;
  Index slice_count;
  const Index* ring;
  const double* coefficients;  ///< a_pq / a_pp per entry of the ring
  const double* diagonal;      ///< a_pp per slot
};

/// The vectors of BiCGSTAB.
struct SolverVectors {
  Quad<double>* x;       ///< solution
  Quad<double>* r;       ///< residual of the scaled system
  Quad<double>* shadow;  ///< residual at the start
  Quad<double>* p;       ///< direction
  Quad<double>* v;       ///< D⁻¹ A p
  Quad<double>* t;       ///< D⁻¹ A s, s = r − α v
};

/// The scalars of an iteration, one per column.
struct SolverScalars {
  Quad<double> alpha, beta, omega;
};

/// Inner products over a range of slots, one per column; which ones, each kernel says.
struct SolverSums {
  Quad<double> a, b, c, d;
};

/// The kernels of one instruction set; each works on slices [first, last).
struct SystemKernels {
  /// Diagonal (1 where there is no area) and scaled coefficients, from positions in L.
  void (*assemble)(const KernelMesh<double>&, const std::uint8_t* strong, const SystemNumbers&,
                   Index first, Index last, double* coefficients, double* diagonal);
  /// x = 0, r = r̃ = p = D⁻¹ b. Sums: |b|², |r|².
  SolverSums (*start)(const ScaledMatrix&, const Quad<double>* b, const SolverVectors&, Index first,
                      Index last);
  /// v. Sums: ⟨r̃, v⟩.
  SolverSums (*search)(const ScaledMatrix&, const SolverVectors&, Index first, Index last);
  /// t. Sums: ⟨t, s⟩, |t|², ⟨r̃, s⟩, ⟨r̃, t⟩.
  SolverSums (*stabilise)(const ScaledMatrix&, const SolverVectors&, const SolverScalars&,
                          Index first, Index last);
  /// x, r and p of the next iteration. Sums: |D r|².
  SolverSums (*advance)(const ScaledMatrix&, const SolverVectors&, const SolverScalars&,
                        Index first, Index last);
  /// Sums: |b − A x|².
  SolverSums (*residual)(const ScaledMatrix&, const Quad<double>* b, const Quad<double>* x,
                         Index first, Index last);
};

/// The kernels of an instruction set; portable ones where the build has none for it.
const SystemKernels& system_kernels(Isa isa);

}  // namespace fairway
