// Sums over rings: curvature, areas, the stable step and which edges are strong.
// Sources: Hildebrandt & Polthier 2004, eqs. (1)–(3).

#pragma once

#include "core/feature_kernels_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// Sums over rings whose faces are all there, in stored units, in fewer operations than by normals:
/// Σ H_e N_e = −Σ over the edges of (cot + cot) e, eq. (3), where the two forms agree; at boundary
/// edges, which count nothing, the difference comes off.
template <class Real, bool kPrescribed>
struct WholeRing {
  using V = Lanes<Real>;
  Vectors<Real> curvature;    ///< Σ H_e N_e
  Vectors<Real> area_vector;  ///< Σ twice area · N
  V twice_area;
  V cotangents;  ///< Σ (|cot| + |cot|) = 2 K_pp
  V least;       ///< least squared twice area

  static constexpr Real kLargest = static_cast<Real>(3e38);

  FAIRWAY_INLINE WholeRing() {
    const V zero = {};
    curvature.x = curvature.y = curvature.z = zero;
    area_vector.x = area_vector.y = area_vector.z = zero;
    twice_area = cotangents = zero;
    least = zero + kLargest;
  }

  /// The triangle (p, a, b).
  struct Face {
    Vectors<Real> n;  ///< twice the area vector
    V inverse;        ///< 1 / |n|
    V cot_a, cot_b;   ///< at a and b
  };
  FAIRWAY_INLINE Face add_face(const Vectors<Real>& a, V aa, const Vectors<Real>& b, V bb) {
    Face f;
    f.n = cross(a, b);
    const V squared = dot(f.n, f.n);
    least = smaller(squared, least);
    f.inverse = inverse_root(squared);
    twice_area += squared * f.inverse;
    const V ab = dot(a, b);
    f.cot_a = (aa - ab) * f.inverse;
    f.cot_b = (bb - ab) * f.inverse;
    cotangents += magnitude(f.cot_a) + magnitude(f.cot_b);
    if constexpr (kPrescribed) area_vector = area_vector + f.n;
    return f;
  }

  /// The edge along `e` with `left` counter-clockwise of it. Returns which lanes are strong:
  /// |H_e|² = |e|² |N0 − N1|² = 2 |e|² (1 − ⟨N0, N1⟩) > λ² = 2 `half`.
  FAIRWAY_INLINE std::uint8_t add_edge(const Face& left, const Face& right, const Vectors<Real>& e,
                                       V ee, Real half) {
    curvature = curvature - e * (left.cot_b + right.cot_a);
    const V cosine = (left.inverse * right.inverse) * dot(left.n, right.n);
    return static_cast<std::uint8_t>(bits_of(ee - ee * cosine > half));
  }
};

/// `kValence`: of the slice, so that the loop unrolls and its registers need no moving; 0 = any.
template <class Real, bool kPrescribed, bool kOpen, Index kValence>
FAIRWAY_INLINE WholeRing<Real, kPrescribed> sum_whole_ring(const KernelMesh<Real>& mesh,
                                                           const Threshold<Real>& threshold,
                                                           Index slice, const Gathered<Real>& p,
                                                           std::uint8_t* strong) {
  using V = Lanes<Real>;
  using Face = typename WholeRing<Real, kPrescribed>::Face;
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Index valence = kValence == 0 ? s.valence : kValence;
  const Real half = threshold.squared / 2;
  const auto edge_to = [&](Index k) FAIRWAY_LAMBDA {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
  WholeRing<Real, kPrescribed> sums;
  const Vectors<Real> first = edge_to(0);
  const V first_squared = dot(first, first);
  Vectors<Real> a = edge_to(1);
  V aa = dot(a, a);
  const Face first_face = sums.add_face(first, first_squared, a, aa);
  Face before = first_face;
#pragma GCC unroll 8
  for (Index k = 1; k + 1 < valence; ++k) {
    const Vectors<Real> b = edge_to(k + 1);
    const V bb = dot(b, b);
    const Face face = sums.add_face(a, aa, b, bb);
    strong[k] = sums.add_edge(face, before, a, aa, half);
    before = face;
    a = b;
    aa = bb;
  }
  if constexpr (kOpen) {
    strong[0] = strong[valence - 1] = 0;
    sums.curvature = sums.curvature - first * first_face.cot_b -
                     cross(first, first_face.n * first_face.inverse) - a * before.cot_a +
                     cross(a, before.n * before.inverse);
  } else {
    const Face face = sums.add_face(a, aa, first, first_squared);
    strong[valence - 1] = sums.add_edge(face, before, a, aa, half);
    strong[0] = sums.add_edge(first_face, face, first, first_squared, half);
  }
  return sums;
}

/// Sums over the rings of eight vertices some of whose faces are absent, in stored units: by edges,
/// as the equations have it.
template <class Real>
struct TornRing {
  using V = Lanes<Real>;
  Vectors<Real> curvature;    ///< Σ H_e N_e
  Vectors<Real> area_vector;  ///< Σ twice area · N
  V twice_area;
  V cotangents;  ///< Σ (|cot| + |cot|) = 2 K_pp

  /// Number by number: g++ 12 clears a whole object in memory.
  FAIRWAY_INLINE TornRing() {
    const V zero = {};
    curvature.x = curvature.y = curvature.z = zero;
    area_vector.x = area_vector.y = area_vector.z = zero;
    twice_area = cotangents = zero;
  }

  FAIRWAY_INLINE void add_face(const Fan<Real>& fan, const Vectors<Real>& a, V aa,
                               const Vectors<Real>& b, V bb) {
    area_vector = area_vector + fan.twice_area_vector;
    twice_area += fan.twice_area;
    const V ab = dot(a, b);
    cotangents += (magnitude(aa - ab) + magnitude(bb - ab)) * fan.inverse;
  }

  /// The edge along `e` with `left` counter-clockwise of it. Returns which lanes are strong.
  FAIRWAY_INLINE std::uint8_t add_edge(const Fan<Real>& left, const Fan<Real>& right,
                                       const Vectors<Real>& e, Real lambda_squared) {
    const V zero = {};
    const Mask<Real> torn = left.absent | right.absent;
    const Vectors<Real> term =
        select(torn, Vectors<Real>{zero, zero, zero}, cross(e, left.normal - right.normal));
    curvature = curvature + term;
    return static_cast<std::uint8_t>(bits_of(dot(term, term) > lambda_squared));
  }
};

/// Rare, and so out of the way.
template <class Real>
__attribute__((noinline, cold)) void sum_torn_ring(const KernelMesh<Real>& mesh,
                                                   const Threshold<Real>& threshold, Index slice,
                                                   std::uint8_t* strong, TornRing<Real>& sums) {
  using V = Lanes<Real>;
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Gathered<Real> p = own<Real>(mesh.positions, slice);
  const auto edge_to = [&](Index k) {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
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
  if (s.open) {
    strong[0] = strong[s.valence - 1] = 0;
  } else {
    const Fan<Real> last_face(b, first, threshold.least);
    sums.add_face(last_face, b, bb, first, first_squared);
    strong[s.valence - 1] = sums.add_edge(last_face, before, b, threshold.squared);
    strong[0] = sums.add_edge(first_face, last_face, first, threshold.squared);
  }
}

/// Calls use(sums) for the ring sums of a slice; inlined on every way, so that they stay in
/// registers.
template <class Real, bool kPrescribed, bool kOpen, Index kValence, class Use>
FAIRWAY_INLINE void with_ring_sums(const KernelMesh<Real>& mesh, const Threshold<Real>& threshold,
                                   Index slice, const Gathered<Real>& p, std::uint8_t* strong,
                                   const Use& use) {
  const auto sums =
      sum_whole_ring<Real, kPrescribed, kOpen, kValence>(mesh, threshold, slice, p, strong);
  if (bits_of(sums.least <= threshold.least) == 0) {
    use(sums);
  } else {
    TornRing<Real> torn;
    sum_torn_ring(mesh, threshold, slice, strong, torn);
    use(torn);
  }
}
template <class Real, bool kPrescribed, class Use>
FAIRWAY_INLINE void with_ring_sums(const KernelMesh<Real>& mesh, const Threshold<Real>& threshold,
                                   Index slice, const Gathered<Real>& p, std::uint8_t* strong,
                                   const Use& use) {
  const Slice& s = mesh.slices[slice];
  std::uint8_t* columns = strong + s.columns;
  if (s.open) {
    with_ring_sums<Real, kPrescribed, true, 0>(mesh, threshold, slice, p, columns, use);
  } else if (s.valence == 6) {
    with_ring_sums<Real, kPrescribed, false, 6>(mesh, threshold, slice, p, columns, use);
  } else if (s.valence == 5) {
    with_ring_sums<Real, kPrescribed, false, 5>(mesh, threshold, slice, p, columns, use);
  } else if (s.valence == 7) {
    with_ring_sums<Real, kPrescribed, false, 7>(mesh, threshold, slice, p, columns, use);
  } else {
    with_ring_sums<Real, kPrescribed, false, 0>(mesh, threshold, slice, p, columns, use);
  }
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
