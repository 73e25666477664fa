#pragma once

#include <cstddef>
#include <cstdint>

#include "core/slice.h"

namespace fairway {

// The inner loops of the flows over a PackedMesh. Lengths are in mean edges L. The same source is
// compiled for several instruction sets (flow_kernels_impl.h); everything here is plain data, so
// that nothing compiled for one of them is shared with code for another.

/// How positions are stored: single precision computes with 32-bit fixed point, so that edge
/// vectors are exact differences wherever the vertex lies; double precision stores doubles.
template <class Real>
struct StoredCoordinate;
template <>
struct StoredCoordinate<float> {
  using Type = std::int32_t;
};
template <>
struct StoredCoordinate<double> {
  using Type = double;
};

/// Four numbers of one slot.
template <class T>
struct alignas(4 * sizeof(T)) Quad {
  T x, y, z, w;
};

/// What every kernel reads: the mesh and where its slots are.
template <class Real>
struct KernelMesh {
  const Slice* slices;
  const Index* ring;
  const Quad<typename StoredCoordinate<Real>::Type>* positions;
  Real quantum;  ///< length of one unit of a stored coordinate: 1 in double precision
};

/// What a flow computes per slot before it moves. The mean curvature flows that move in one pass
/// need no curvature and direction.
template <class Real>
struct KernelFields {
  Quad<Real>* curvature;  ///< H_A, and in w the factor c of the step: p ← p − c (…)
  Quad<Real>* direction;  ///< ∇vol, later V_A at feature vertices; in w 1 / M_pp
  Real* value;            ///< f, signed, its lowest bit says "feature vertex"
  std::uint8_t* strong;   ///< per column, a bit per lane: |H_e| > λ
};

/// Strong edges, as arrays of slots: their ends p < q and the vertices opposite, `left` of p→q
/// counter-clockwise. The arrays are readable for eight entries past the last.
struct StrongEdges {
  const Index* p;
  const Index* q;
  const Index* left;
  const Index* right;
  std::size_t count;
};

/// How f is found; the values of CurvatureMeasure.
enum class KernelMeasure { length, project, mass };

/// The numbers of one step.
template <class Real>
struct StepNumbers {
  Real time_step;   ///< s in L²
  Real lambda;      ///< λ in L; infinite for the isotropic flows
  Real transition;  ///< r
  bool local_step;  ///< c = min(s / M_pp, ½ / K_pp)
  bool prescribed;  ///< direction and value are wanted
  KernelMeasure measure = KernelMeasure::length;
  bool all_neighbours = false;  ///< H_A^s averages over all neighbours, not feature vertices only
};

/// How the moving pass averages f and where it writes.
template <class Real>
struct MoveNumbers {
  Real fraction;  ///< of the last smoothing pass; 0 = f as it is
  bool own_kind;  ///< every vertex averages over its own kind only
  /// L² in the unit of the input. Where the paper's literal rule mixes the two kinds of f, which
  /// are a length and one over a length, the result depends on that unit.
  Real mean_edge_squared;
  bool prescribed;
};

/// The kernels of one instruction set; each works on slices [first, last).
template <class Real>
struct FlowKernels {
  using Position = Quad<typename StoredCoordinate<Real>::Type>;

  /// |N0 − N1|² of each ring edge into `out`, 8 numbers per column from `out[0]` on for slice
  /// `first`; −1 at boundaries and beside absent faces.
  void (*bends)(const KernelMesh<Real>&, Index first, Index last, Real* out);
  /// The least height of a face, in stored units.
  Real (*least_height)(const KernelMesh<Real>&, Index first, Index last);
  /// Unit area-weighted normals into `out`, 8 per slice from `out[0]` on; 0 where there is none.
  void (*normals)(const KernelMesh<Real>&, Index first, Index last, Quad<Real>* out);
  /// Fills the fields: H (weights 1), c, ∇vol, f of a non-feature vertex, strong edges.
  void (*curvature)(const KernelMesh<Real>&, const StepNumbers<Real>&, const KernelFields<Real>&,
                    Index first, Index last);
  /// p − c H into `out`, weights 1, the bits of c into its w; strong edges. Returns like `move`.
  Real (*contract)(const KernelMesh<Real>&, const StepNumbers<Real>&, const KernelFields<Real>&,
                   Index first, Index last, Position* out);
  /// Gives strong edges their weight: takes ½ (1 − w) H_e N_e from H_A at both ends.
  void (*weaken)(const KernelMesh<Real>&, const StepNumbers<Real>&, const StrongEdges&,
                 Quad<Real>* curvature);
  /// The same after `contract`, whose `out` this takes. Returns the largest component of what
  /// an edge moved a vertex by, in stored units.
  Real (*weaken_moved)(const KernelMesh<Real>&, const StepNumbers<Real>&, const StrongEdges&,
                       Position* out);
  /// V_A at the feature vertices, a bit per lane in `features`, one byte per slice.
  void (*direct)(const KernelMesh<Real>&, const StepNumbers<Real>&, const KernelFields<Real>&,
                 const std::uint8_t* features, Index first, Index last);
  /// f anew in slices with feature vertices, from H_A and V_A; its kind stays.
  void (*revalue)(const StepNumbers<Real>&, const KernelFields<Real>&, const std::uint8_t* features,
                  Index first, Index last);
  /// One smoothing pass of f into `out`.
  void (*average)(const KernelMesh<Real>&, const MoveNumbers<Real>&, const Real* value, Index first,
                  Index last, Real* out);
  /// p − c (H_A − f̃ V_A) into `out`, f̃ from one more averaging of f. Returns the largest coordinate
  /// magnitude in stored units; NaN or infinity if one is not finite.
  Real (*move)(const KernelMesh<Real>&, const MoveNumbers<Real>&, const KernelFields<Real>&,
               Index first, Index last, Position* out);
  /// Σ ⟨p − start, normal⟩² over the slots, in L²; 8 normals per slice from `normals[0]` on.
  double (*displacement)(const KernelMesh<Real>&, const Position* start, const Quad<Real>* normals,
                         Index first, Index last);
};

/// Instruction sets, in rising order.
enum class Isa { portable, avx2, avx512 };

/// The best one this processor has.
Isa best_isa();
const char* name_of(Isa isa);

/// The kernels of an instruction set; portable ones where the build has none for it.
template <class Real>
const FlowKernels<Real>& flow_kernels(Isa isa);
template <>
const FlowKernels<float>& flow_kernels<float>(Isa isa);
template <>
const FlowKernels<double>& flow_kernels<double>(Isa isa);

}  // namespace fairway
