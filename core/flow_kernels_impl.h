// The kernels of the flows, compiled once per instruction set by the flow_kernels_*.cpp files.
// Sources: Hildebrandt & Polthier 2004, eqs. (2), (6), (8), (11).

#pragma once

#include "core/ring_sums_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

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
      store_moved(out + slot, p, sums.curvature * (factor / 2), factor, largest);
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
Real least_height(const KernelMesh<Real>& mesh, Index first, Index last) {
  constexpr Real kNone = static_cast<Real>(3e38);
  Lanes<Real> least = all(kNone);
  for (Index slice = first; slice < last; ++slice) {
    const Slice& s = mesh.slices[slice];
    const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
    const Gathered<Real> p = own<Real>(mesh.positions, slice);
    const auto edge_to = [&](Index k) {
      return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
    };
    const auto look = [&](const Vectors<Real>& a, const Vectors<Real>& b) FAIRWAY_LAMBDA {
      const Vectors<Real> n = cross(a, b);
      const Vectors<Real> c = b - a;
      const Lanes<Real> longest = -smaller(-dot(a, a), smaller(-dot(b, b), -dot(c, c)));
      // Slots without a vertex have no edges.
      least = select(longest > Lanes<Real>{}, smaller(dot(n, n) / longest, least), least);
    };
    const Vectors<Real> begin = edge_to(0);
    Vectors<Real> a = begin;
    for (Index k = 1; k < s.valence; ++k) {
      const Vectors<Real> b = edge_to(k);
      look(a, b);
      a = b;
    }
    if (!s.open) look(a, begin);
  }
  Real out = least[0];
  for (int i = 1; i < 8; ++i) out = least[i] < out ? least[i] : out;
  return square_root(all(out))[0];
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
    store_moved(out + slot, own<Real>(mesh.positions, slice), by * (h.w * per_quantum),
                Lanes<Real>{}, largest);
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
constexpr FlowKernels<Real> kKernels = {
    &bends<Real>,    &least_height<Real>, &normals<Real>,      &curvature<Real>,
    &contract<Real>, &weaken<Real>,       &weaken_moved<Real>, &direct<Real>,
    &revalue<Real>,  &average<Real>,      &move<Real>,         &displacement<Real>};

}  // namespace

const FlowKernels<float>& single_kernels() {
  return kKernels<float>;
}
const FlowKernels<double>& double_kernels() {
  return kKernels<double>;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
