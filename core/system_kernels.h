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

/// Where rows go, in both precisions; see ScaledMatrix.
struct SystemEntries {
  double* coefficients;
  double* diagonal;
  float* rounded_coefficients;
  float* rounded_diagonal;
};

/// Rows over rings, scaled to a unit diagonal: D⁻¹ A.
template <class Real>
struct ScaledMatrix {
  const Slice* slices;
  Index slice_count;
  const Index* ring;
  const Real* coefficients;  ///< a_pq / a_pp per entry of the ring
  const Real* diagonal;      ///< a_pp per slot
};

/// The vectors of BiCGSTAB.
template <class Real>
struct SolverVectors {
  Quad<Real>* x;       ///< solution
  Quad<Real>* r;       ///< residual of the scaled system
  Quad<Real>* shadow;  ///< residual at the start
  Quad<Real>* p;       ///< direction
  Quad<Real>* v;       ///< D⁻¹ A p
  Quad<Real>* t;       ///< D⁻¹ A s, s = r − α v
};

/// The scalars of an iteration, one per column.
struct SolverScalars {
  Quad<double> alpha, beta, omega;
};

/// Inner products over a range of slots, one per column; which ones, each kernel says.
struct SolverSums {
  Quad<double> a, b, c, d;
};

/// The iteration in one precision. Sums are added up in double, of each slice in Real.
template <class Real>
struct SolverKernels {
  /// For the residual e = b − A x: r = r̃ = p = factor D⁻¹ e, and 0 for the x of the vectors.
  /// Sums: |e|², |r|².
  SolverSums (*restart)(const ScaledMatrix<double>&, const Quad<double>* b, const Quad<double>* x,
                        const Quad<double>& factor, const SolverVectors<Real>&, Index first,
                        Index last);
  /// v. Sums: ⟨r̃, v⟩.
  SolverSums (*search)(const ScaledMatrix<Real>&, const SolverVectors<Real>&, Index first,
                       Index last);
  /// t. Sums: ⟨t, s⟩, |t|², ⟨r̃, s⟩, ⟨r̃, t⟩.
  SolverSums (*stabilise)(const ScaledMatrix<Real>&, const SolverVectors<Real>&,
                          const SolverScalars&, Index first, Index last);
  /// x, r and p of the next iteration. Sums: |D r|².
  SolverSums (*advance)(const ScaledMatrix<Real>&, const SolverVectors<Real>&, const SolverScalars&,
                        Index first, Index last);
  /// x += factor times the `correction`.
  void (*correct)(const Quad<Real>* correction, const Quad<double>& factor, Index first, Index last,
                  Quad<double>* x);
};

/// The kernels of one instruction set; each works on slices [first, last).
struct SystemKernels {
  /// Diagonal (1 where there is no area) and scaled coefficients, from positions in L.
  void (*assemble)(const KernelMesh<double>&, const std::uint8_t* strong, const SystemNumbers&,
                   Index first, Index last, const SystemEntries&);
  /// Sums: |b|², |D⁻¹ b|².
  SolverSums (*size)(const double* diagonal, const Quad<double>* b, Index first, Index last);
  SolverKernels<float> in_single;
  SolverKernels<double> in_double;
};

/// The kernels of an instruction set; portable ones where the build has none for it.
const SystemKernels& system_kernels(Isa isa);

}  // namespace fairway
