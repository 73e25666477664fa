// The kernels of the flows, compiled once per instruction set by the flow_kernels_*.cpp files.
// Sources: Hildebrandt & Polthier 2004, eqs. (2), (6), (8), (11).

#pragma once

#include "core/feature_kernels_impl.h"
#include "core/lane_memory_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// Sums over the rings of eight vertices, in stored units. Unless `kTorn`, all faces are taken for
/// present, and `absent` says afterwards whether that was wrong.
template <class Real, bool kPrescribed, bool kTorn>
struct Sums {
  using V = Lanes<Real>;
  Vectors<Real> curvature;    ///< Σ H_e N_e
  Vectors<Real> area_vector;  ///< Σ twice area · N
  V twice_area;
  V cotangents;  ///< Σ (|cot| + |cot|) = 2 K_pp
  Mask<Real> absent;

  /// Number by number: g++ 12 clears a whole object in memory.
  FAIRWAY_INLINE Sums() {
    const V zero = {};
    curvature.x = curvature.y = curvature.z = zero;
    area_vector.x = area_vector.y = area_vector.z = zero;
    twice_area = cotangents = zero;
    absent = bits_as_mask(zero);
  }

  FAIRWAY_INLINE void add_face(const Fan<Real>& fan, const Vectors<Real>& a, V aa,
                               const Vectors<Real>& b, V bb) {
    if constexpr (kPrescribed) area_vector = area_vector + fan.twice_area_vector;
    twice_area += fan.twice_area;
    const V ab = dot(a, b);
    cotangents += (magnitude(aa - ab) + magnitude(bb - ab)) * fan.inverse;
    if constexpr (!kTorn) absent = absent | fan.absent;
  }

  /// The edge along `e` with `left` counter-clockwise of it. Returns which lanes are strong.
  FAIRWAY_INLINE std::uint8_t add_edge(const Fan<Real>& left, const Fan<Real>& right,
                                       const Vectors<Real>& e, Real lambda_squared) {
    Vectors<Real> term = cross(e, left.normal - right.normal);
    if constexpr (kTorn) {
      const V zero = {};
      const Mask<Real> torn = left.absent | right.absent;
      term = select<Real>(torn, {zero, zero, zero}, term);
    }
    curvature = curvature + term;
    return static_cast<std::uint8_t>(bits_of(dot(term, term) > lambda_squared));
  }
};

template <class Real, bool kPrescribed, bool kOpen, bool kTorn>
FAIRWAY_INLINE Sums<Real, kPrescribed, kTorn> sum_ring(const KernelMesh<Real>& mesh,
                                                       const Threshold<Real>& threshold,
                                                       Index slice, const Gathered<Real>& p,
                                                       std::uint8_t* strong) {
  using V = Lanes<Real>;
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const auto edge_to = [&](Index k) {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
  Sums<Real, kPrescribed, kTorn> sums;
  const Vectors<Real> first = edge_to(0);
  const V first_squared = dot(first, first);
  Vectors<Real> a = first;
  V aa = first_squared;
  Vectors<Real> b = edge_to(1);
  V bb = dot(b, b);
  const Fan<Real> first_face(a, b, threshold.least);
  sums.add_face(first_face, a, aa, b, bb);
  Fan<Real> before = first_face;
  for (Index k = 1; k + 1 < s.valence; ++k) {
    a = b;
    aa = bb;
    b = edge_to(k + 1);
    bb = dot(b, b);
    const Fan<Real> face(a, b, threshold.least);
    sums.add_face(face, a, aa, b, bb);
    strong[k] = sums.add_edge(face, before, a, threshold.squared);
    before = face;
  }
  if constexpr (kOpen) {
    strong[0] = strong[s.valence - 1] = 0;
  } else {
    const Fan<Real> last_face(b, first, threshold.least);
    sums.add_face(last_face, b, bb, first, first_squared);
    strong[s.valence - 1] = sums.add_edge(last_face, before, b, threshold.squared);
    strong[0] = sums.add_edge(first_face, last_face, first, threshold.squared);
  }
  return sums;
}

/// Rare, and so out of the way.
template <class Real, bool kPrescribed, bool kOpen>
__attribute__((noinline, cold)) void sum_torn_ring(const KernelMesh<Real>& mesh,
                                                   const Threshold<Real>& threshold, Index slice,
                                                   std::uint8_t* strong,
                                                   Sums<Real, kPrescribed, true>& out) {
  out = sum_ring<Real, kPrescribed, kOpen, true>(mesh, threshold, slice,
                                                 own<Real>(mesh.positions, slice), strong);
}

/// Calls use(sums) for the ring sums of a slice; inlined on every way, so that they stay in
/// registers.
template <class Real, bool kPrescribed, bool kOpen, class Use>
FAIRWAY_INLINE void with_ring_sums(const KernelMesh<Real>& mesh, const Threshold<Real>& threshold,
                                   Index slice, const Gathered<Real>& p, std::uint8_t* strong,
                                   const Use& use) {
  const auto sums = sum_ring<Real, kPrescribed, kOpen, false>(mesh, threshold, slice, p, strong);
  if (bits_of(sums.absent) == 0) {
    use(sums);
  } else {
    Sums<Real, kPrescribed, true> torn;
    sum_torn_ring<Real, kPrescribed, kOpen>(mesh, threshold, slice, strong, torn);
    use(torn);
  }
}
template <class Real, bool kPrescribed, class Use>
FAIRWAY_INLINE void with_ring_sums(const KernelMesh<Real>& mesh, const Threshold<Real>& threshold,
                                   Index slice, const Gathered<Real>& p, std::uint8_t* strong,
                                   const Use& use) {
  std::uint8_t* columns = strong + mesh.slices[slice].columns;
  if (mesh.slices[slice].open) {
    with_ring_sums<Real, kPrescribed, true>(mesh, threshold, slice, p, columns, use);
  } else {
    with_ring_sums<Real, kPrescribed, false>(mesh, threshold, slice, p, columns, use);
  }
}

/// c = s / M_pp, not more than ½ / K_pp where the step is local; 0 without a face.
template <class Real, class RingSums>
FAIRWAY_INLINE Lanes<Real> step_factor(const RingSums& sums, const StepNumbers<Real>& numbers,
                                       Real quantum) {
  const Lanes<Real> zero = {};
  // 1 / M_pp = 6 / Σ twice area; ½ / K_pp = 1 / Σ cotangents.
  Lanes<Real> step = 6 * numbers.time_step / (sums.twice_area * (quantum * quantum));
  if (numbers.local_step) {
    const Lanes<Real> stable = 1 / sums.cotangents;
    step = select(step < stable, step, stable);
  }
  return select(sums.twice_area > zero, step, zero);
}

template <class Real, bool kPrescribed>
void curvature(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
               const KernelFields<Real>& fields, Index first, Index last) {
  using V = Lanes<Real>;
  const V zero = {};
  const Real quantum = mesh.quantum;
  const Threshold<Real> threshold(numbers, quantum);
  for (Index slice = first; slice < last; ++slice) {
    const std::size_t slot = kLanes * std::size_t{slice};
    const auto use = [&](const auto& sums) FAIRWAY_LAMBDA {
      const Vectors<Real> h = sums.curvature * all(quantum / 2);
      store_quads(fields.curvature + slot, h, step_factor(sums, numbers, quantum));
      if constexpr (kPrescribed) {
        const Vectors<Real> volume = sums.area_vector * all(quantum * quantum / 6);
        const V per_mass =
            select(sums.twice_area > zero, 6 / (sums.twice_area * (quantum * quantum)), zero);
        store_quads(fields.direction + slot, volume, per_mass);
        const V f = curvature_value<Real>(numbers.measure, h, volume, per_mass, Mask<Real>{});
        store(fields.value + slot, with_kind<Real>(f, Mask<Real>{}));
      }
    };
    with_ring_sums<Real, kPrescribed>(mesh, threshold, slice, own<Real>(mesh.positions, slice),
                                      fields.strong, use);
  }
}

template <class Real>
void curvature(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
               const KernelFields<Real>& fields, Index first, Index last) {
  if (numbers.prescribed) {
    curvature<Real, true>(mesh, numbers, fields, first, last);
  } else {
    curvature<Real, false>(mesh, numbers, fields, first, last);
  }
}

template <class Real>
Real contract(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
              const KernelFields<Real>& fields, Index first, Index last, Stored<Real>* out) {
  const Threshold<Real> threshold(numbers, mesh.quantum);
  LargestMagnitude<Real> largest;
  for (Index slice = first; slice < last; ++slice) {
    const Gathered<Real> p = own<Real>(mesh.positions, slice);
    const std::size_t slot = kLanes * std::size_t{slice};
    const auto use = [&](const auto& sums) FAIRWAY_LAMBDA {
      const Lanes<Real> factor = step_factor(sums, numbers, mesh.quantum);
      store(fields.value + slot, factor);
      store_moved(out + slot, p, sums.curvature * (factor / 2), largest);
    };
    with_ring_sums<Real, false>(mesh, threshold, slice, p, fields.strong, use);
  }
  return largest.value();
}

/// Calls visit(number of the edge, left face, right face) for the ring edges of a slice; faces
/// beside a boundary are absent.
template <class Real, class Visit>
FAIRWAY_INLINE void for_ring_edges(const KernelMesh<Real>& mesh, Index slice, const Visit& visit) {
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Real least = least_twice_area_squared(mesh.quantum);
  const Gathered<Real> p = own<Real>(mesh.positions, slice);
  const auto edge_to = [&](Index k) {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
  const Vectors<Real> first_edge = edge_to(0);
  Vectors<Real> a = edge_to(1);
  const Fan<Real> first_face(first_edge, a, least);
  Fan<Real> before = first_face;
  for (Index k = 1; k + 1 < s.valence; ++k) {
    const Vectors<Real> b = edge_to(k + 1);
    const Fan<Real> face(a, b, least);
    visit(k, face, before);
    before = face;
    a = b;
  }
  Fan<Real> last_face(a, first_edge, least);
  if (s.open) last_face.remove();
  visit(s.valence - 1, last_face, before);
  visit(0, first_face, last_face);
}

template <class Real>
void bends(const KernelMesh<Real>& mesh, Index first, Index last, Real* out) {
  const Lanes<Real> zero = {};
  for (Index slice = first; slice < last; ++slice) {
    for_ring_edges(mesh, slice, [&](Index k, const Fan<Real>& left, const Fan<Real>& right) {
      const Vectors<Real> difference = left.normal - right.normal;
      const Mask<Real> torn = left.absent | right.absent;
      store(out + kLanes * std::size_t{k}, select(torn, zero - 1, dot(difference, difference)));
    });
    out += kLanes * std::size_t{mesh.slices[slice].valence};
  }
}

template <class Real>
void normals(const KernelMesh<Real>& mesh, Index first, Index last, Quad<Real>* out) {
  const Lanes<Real> zero = {};
  for (Index slice = first; slice < last; ++slice, out += kLanes) {
    Vectors<Real> sum = {};
    for_ring_edges(mesh, slice,
                   [&](Index /*k*/, const Fan<Real>& left, const Fan<Real>& /*right*/) {
                     sum = sum + left.twice_area_vector * all(mesh.quantum * mesh.quantum);
                   });
    const Lanes<Real> squared = dot(sum, sum);
    const Lanes<Real> inverse = select(squared > zero, 1 / square_root(squared), zero);
    store_quads(out, sum * inverse, zero);
  }
}

/// (1 − m) f + m · average of f over the neighbours that count.
template <class Real>
FAIRWAY_INLINE Lanes<Real> averaged(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers,
                                    const Real* value, Index slice) {
  using V = Lanes<Real>;
  const V zero = {};
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const V f = load(value + kLanes * std::size_t{slice});
  const Mask<Real> kind = kind_of<Real>(f);
  V sum = zero;
  V count = zero;
  for (Index k = 0; k < s.valence; ++k) {
    V q = gather_values(value, column + kLanes * std::size_t{k});
    const Mask<Real> same = kind_of<Real>(q) == kind;
    Mask<Real> counts = same;
    if (!numbers.own_kind) {
      counts = counts | (kind == 0);
      q = select(same, q, q * numbers.mean_edge_squared);
    }
    sum += select(counts, q, zero);
    count += select(counts, zero + 1, zero);
  }
  const V mean = (1 - numbers.fraction) * f + numbers.fraction * sum / count;
  return select(count > zero, mean, f);
}

template <class Real>
void average(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers, const Real* value,
             Index first, Index last, Real* out) {
  for (Index slice = first; slice < last; ++slice) {
    const std::size_t slot = kLanes * std::size_t{slice};
    const Mask<Real> kind = kind_of<Real>(load(value + slot));
    store(out + slot, with_kind<Real>(averaged(mesh, numbers, value, slice), kind));
  }
}

template <class Real>
Real move(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers,
          const KernelFields<Real>& fields, Index first, Index last, Stored<Real>* out) {
  const Real per_quantum = 1 / mesh.quantum;
  LargestMagnitude<Real> largest;
  for (Index slice = first; slice < last; ++slice) {
    const std::size_t slot = kLanes * std::size_t{slice};
    const Quads<Real> h = own_quads(fields.curvature, slice);
    Vectors<Real> by = h.xyz;
    if (numbers.prescribed) {
      const Lanes<Real> f = numbers.fraction > 0 ? averaged(mesh, numbers, fields.value, slice)
                                                 : load(fields.value + slot);
      by = by - own_quads(fields.direction, slice).xyz * f;
    }
    store_moved(out + slot, own<Real>(mesh.positions, slice), by * (h.w * per_quantum), largest);
  }
  return largest.value();
}

template <class Real>
double displacement(const KernelMesh<Real>& mesh, const Stored<Real>* start,
                    const Quad<Real>* normals, Index first, Index last) {
  double sum = 0.0;
  for (Index slice = first; slice < last; ++slice) {
    const Vectors<Real> by =
        between(own<Real>(start, slice), own<Real>(mesh.positions, slice)) * all(mesh.quantum);
    const Lanes<Real> d = dot(by, own_quads(normals, slice - first).xyz);
    Real part = 0;
    for (int i = 0; i < 8; ++i) part += d[i] * d[i];
    sum += static_cast<double>(part);
  }
  return sum;
}

template <class Real>
constexpr FlowKernels<Real> kKernels = {&bends<Real>,    &normals<Real>,     &curvature<Real>,
                                        &contract<Real>, &weaken<Real>,      &weaken_moved<Real>,
                                        &direct<Real>,   &revalue<Real>,     &average<Real>,
                                        &move<Real>,     &displacement<Real>};

}  // namespace

const FlowKernels<float>& single_kernels() {
  return kKernels<float>;
}
const FlowKernels<double>& double_kernels() {
  return kKernels<double>;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
