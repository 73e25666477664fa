// Faces, strong edges and feature vertices in lanes: what is special about edges beyond λ.
// Sources: Hildebrandt & Polthier 2004, eqs. (2), (6) and the text before (11).

#pragma once

#include <algorithm>

#include "core/lane_memory_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// (2 · 1e-12 L²)² in stored units: faces with less area count as absent.
template <class Real>
FAIRWAY_INLINE Real least_twice_area_squared(Real quantum) {
  const Real root = static_cast<Real>(2e-12) / quantum / quantum;
  return root * root;
}

/// The triangles (p, a, b) of eight rings, a and b relative to p: unit normals and what else the
/// sums need, in stored units.
template <class V>
struct FanOf {
  using Scalar = typename Traits<V>::Scalar;

  VectorsOf<V> twice_area_vector;
  VectorsOf<V> normal;  ///< 0 where absent
  V twice_area;         ///< 0 where absent
  V inverse;            ///< 1 / twice_area, 0 where absent
  typename Traits<V>::Mask absent;

  FAIRWAY_INLINE FanOf(const VectorsOf<V>& a, const VectorsOf<V>& b, Scalar least_squared) {
    const V zero = {};
    twice_area_vector = cross(a, b);
    const V squared = dot(twice_area_vector, twice_area_vector);
    const V length = square_root(squared);
    absent = squared <= least_squared;
    inverse = select(absent, zero, 1 / length);
    twice_area = select(absent, zero, length);
    normal = twice_area_vector * inverse;
  }

  FAIRWAY_INLINE void remove() {
    const V zero = {};
    twice_area_vector = normal = {zero, zero, zero};
    twice_area = inverse = zero;
    absent = ~typename Traits<V>::Mask{};
  }
};

template <class Real>
using Fan = FanOf<Lanes<Real>>;

/// λ and the weight beyond it, for |H_e| in stored units.
template <class Real>
struct Threshold {
  Real squared, inverse, transition;  ///< λ², 1 / λ, r
  Real least;                         ///< least_twice_area_squared()

  FAIRWAY_INLINE Threshold(const StepNumbers<Real>& numbers, Real quantum)
      : squared(numbers.lambda / quantum * (numbers.lambda / quantum)),
        inverse(quantum / numbers.lambda),
        transition(numbers.transition),
        least(least_twice_area_squared(quantum)) {}

  /// w of strong edges with |H_e|² = `h_squared`.
  FAIRWAY_INLINE Lanes<Real> weight(Lanes<Real> h_squared) const {
    const Lanes<Real> excess = square_root(h_squared) * inverse - 1;
    return 1 / (transition * excess * excess + 1);
  }
};

/// f = sign⟨H, V⟩ |H| / |V| or another measure; 0 where V = 0. `feature`: lanes whose V_A is a unit
/// vector, for which a mass means nothing.
template <class Real>
FAIRWAY_INLINE Lanes<Real> curvature_value(KernelMeasure measure, const Vectors<Real>& h,
                                           const Vectors<Real>& direction, Lanes<Real> per_mass,
                                           Mask<Real> feature) {
  using V = Lanes<Real>;
  const V zero = {};
  const V squared = dot(direction, direction);
  const V along = dot(h, direction);
  V f;
  if (measure == KernelMeasure::project) {
    f = along / squared;
  } else {
    f = square_root(dot(h, h) / squared);
    if (measure == KernelMeasure::mass) f = select(feature, f, square_root(dot(h, h)) * per_mass);
    f = select(along < zero, -f, f);
  }
  return select(squared > zero, f, zero);
}

/// ½ (1 − w) H_e N_e of eight strong edges from edges.p[first] on, in stored units.
template <class Real>
FAIRWAY_INLINE Vectors<Real> excess_of(const KernelMesh<Real>& mesh,
                                       const Threshold<Real>& threshold, const StrongEdges& edges,
                                       std::size_t first) {
  const Gathered<Real> p = gather(mesh.positions, edges.p + first);
  const Vectors<Real> e = between(p, gather(mesh.positions, edges.q + first));
  const Vectors<Real> a = between(p, gather(mesh.positions, edges.left + first));
  const Vectors<Real> b = between(p, gather(mesh.positions, edges.right + first));
  const Fan<Real> left(e, a, threshold.least);
  const Fan<Real> right(b, e, threshold.least);
  const Vectors<Real> term = cross(e, left.normal - right.normal);
  return term * ((1 - threshold.weight(dot(term, term))) / 2);
}

template <class Real>
void weaken(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
            const StrongEdges& edges, Quad<Real>* curvature) {
  const Threshold<Real> threshold(numbers, mesh.quantum);
  for (std::size_t first = 0; first < edges.count; first += kLanes) {
    const std::size_t some = std::min<std::size_t>(kLanes, edges.count - first);
    alignas(64) Quad<Real> excess[kLanes];
    store_quads(excess, excess_of(mesh, threshold, edges, first) * all(mesh.quantum),
                Lanes<Real>{});
    for (std::size_t i = 0; i < some; ++i) {
      for (const Index slot : {edges.p[first + i], edges.q[first + i]}) {
        Quad<Real>& h = curvature[slot];
        const Quad<Real>& x = excess[i];
        h = {h.x - x.x, h.y - x.y, h.z - x.z, h.w - x.w};
      }
    }
  }
}

template <class Real>
Real weaken_moved(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
                  const StrongEdges& edges, Stored<Real>* out) {
  const Threshold<Real> threshold(numbers, mesh.quantum);
  LargestMagnitude<Real> largest;
  for (std::size_t first = 0; first < edges.count; first += kLanes) {
    const std::size_t some = std::min<std::size_t>(kLanes, edges.count - first);
    const Vectors<Real> excess = excess_of(mesh, threshold, edges, first);
    for (const Index* ends : {edges.p + first, edges.q + first}) {
      const Vectors<Real> by = excess * gather_w(out, ends);
      for (const Lanes<Real>& c : {by.x, by.y, by.z}) largest.see(c);
      alignas(64) Stored<Real> stored[kLanes];
      store_rounded(stored, by);
      for (std::size_t i = 0; i < some; ++i) add(out[ends[i]], stored[i]);
    }
  }
  return largest.value();
}

/// H_A^s of eight feature vertices, the second summand: Σ ω_q H_A(q) / Σ ω_q over the neighbours
/// that the conventions name; own H_A where there is none.
template <class Real>
FAIRWAY_INLINE Vectors<Real> smoothed_curvature(const KernelMesh<Real>& mesh,
                                                const StepNumbers<Real>& numbers,
                                                const KernelFields<Real>& fields, Index slice) {
  using V = Lanes<Real>;
  const V zero = {};
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Real least = least_twice_area_squared(mesh.quantum);
  const Gathered<Real> p = own<Real>(mesh.positions, slice);
  const auto edge_to = [&](Index k) {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
  const auto angle = [&](const Vectors<Real>& a, const Vectors<Real>& b) {
    const Vectors<Real> n = cross(a, b);
    const V squared = dot(n, n);
    return select(squared > least, angle_of(square_root(squared), dot(a, b)), zero);
  };
  Vectors<Real> sum = {};
  V weights = {};
  const auto add = [&](Index k, V weight) {
    const Index* slots = column + kLanes * std::size_t{k};
    if (!numbers.all_neighbours) {
      weight = select(kind_of<Real>(gather_values(fields.value, slots)) != 0, weight, zero);
    }
    sum = sum + gather_quads(fields.curvature, slots).xyz * weight;
    weights += weight;
  };
  const Vectors<Real> first = edge_to(0);
  Vectors<Real> e = first;
  V first_angle = zero;
  V before = zero;
  for (Index k = 0; k + 1 < s.valence; ++k) {
    const Vectors<Real> next = edge_to(k + 1);
    const V at = angle(e, next);
    if (k == 0) {
      first_angle = at;
    } else {
      add(k, before + at);
    }
    before = at;
    e = next;
  }
  const V last = s.open ? zero : angle(e, first);
  add(s.valence - 1, before + last);
  add(0, last + first_angle);
  const Vectors<Real> own_h = own_quads(fields.curvature, slice).xyz;
  const Mask<Real> any = weights > zero;
  const Vectors<Real> mean = sum * (1 / weights);
  return select(any, (own_h + mean) * all(static_cast<Real>(0.5)), own_h);
}

template <class Real>
void direct(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
            const KernelFields<Real>& fields, const std::uint8_t* features, Index first,
            Index last) {
  using V = Lanes<Real>;
  // |H_A^s| below this many mean edges has no direction.
  constexpr Real kNoDirection = static_cast<Real>(1e-14);
  for (Index slice = first; slice < last; ++slice) {
    if (features[slice] == 0) continue;
    const Vectors<Real> smoothed = smoothed_curvature(mesh, numbers, fields, slice);
    Quad<Real>* out = fields.direction + kLanes * std::size_t{slice};
    const Quads<Real> volume = own_quads(fields.direction, slice);
    const V size = square_root(dot(smoothed, smoothed));
    const Mask<Real> takes = mask_of<Real>(features[slice]) & (size >= kNoDirection);
    const V inverse = 1 / select(dot(smoothed, volume.xyz) < 0, -size, size);
    store_quads(out, select(takes, smoothed * inverse, volume.xyz), volume.w);
  }
}

template <class Real>
void revalue(const StepNumbers<Real>& numbers, const KernelFields<Real>& fields,
             const std::uint8_t* features, Index first, Index last) {
  for (Index slice = first; slice < last; ++slice) {
    if (features[slice] == 0) continue;
    Real* value = fields.value + kLanes * std::size_t{slice};
    const Mask<Real> kind = kind_of<Real>(load(value));
    const Quads<Real> direction = own_quads(fields.direction, slice);
    const Lanes<Real> f =
        curvature_value<Real>(numbers.measure, own_quads(fields.curvature, slice).xyz,
                              direction.xyz, direction.w, kind != 0);
    store(value, with_kind<Real>(f, kind));
  }
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
