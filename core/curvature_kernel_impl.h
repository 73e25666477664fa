// The shape operator, mixed areas and angle defects of eight vertices at a time, in two rounds over
// their rings: normals, areas and angles first, then the edges. Sources: Hildebrandt & Polthier
// 2004, eqs. (4), (5); Meyer et al. 2003 (mixed area); Duff et al. 2017 (tangent basis).

#pragma once

#include <algorithm>

#include "core/curvature_kernel.h"
#include "core/feature_kernels_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

using V8 = Lanes<double>;
using Vec8 = Vectors<double>;

/// Eight vertices whose rings may differ in length.
struct EightRings {
  Index vertex[8], first[8], valence[8], faces[8];
  Index most_faces = 0;
  Mask<double> open;

  EightRings(const RingView& rings, Index from, Index last) {
    std::int64_t is_open[8];
    for (Index i = 0; i < 8; ++i) {
      const Index v = std::min(from + i, last - 1);
      vertex[i] = v;
      first[i] = rings.offsets[v];
      valence[i] = rings.offsets[v + 1] - first[i];
      faces[i] = rings.open[v] != 0 ? valence[i] - 1 : valence[i];
      is_open[i] = rings.open[v] != 0 ? -1 : 0;
      most_faces = std::max(most_faces, faces[i]);
    }
    open = from_array<Mask<double>>(is_open);
  }

  /// Neighbours k; past its end a closed ring goes on with its first, an open one with its last, so
  /// that more faces are absent ones.
  FAIRWAY_INLINE Gathered<double> neighbours(const RingView& rings, Index k) const {
    Index slots[8];
    for (int i = 0; i < 8; ++i) {
      const Index end = faces[i] == valence[i] ? 0 : valence[i] - 1;
      slots[i] = rings.neighbours[first[i] + (k < valence[i] ? k : end)];
    }
    return gather(rings.positions, slots);
  }

  /// The lanes whose last face is face k.
  FAIRWAY_INLINE Mask<double> ends_with(Index k) const {
    std::int64_t lanes[8];
    for (int i = 0; i < 8; ++i) lanes[i] = k + 1 == faces[i] ? -1 : 0;
    return from_array<Mask<double>>(lanes);
  }
};

/// An edge of a ring and the face to its left, as the scratch keeps them.
struct RingEntry {
  Vec8 edge, normal;
  Mask<double> absent;

  FAIRWAY_INLINE void put(double* scratch) const {
    double* to = scratch;
    for (const V8& v : {edge.x, edge.y, edge.z, normal.x, normal.y, normal.z}) {
      store(to, v);
      to += kLanes;
    }
    store(to, bits_as_numbers(absent));
  }
  FAIRWAY_INLINE explicit RingEntry(const double* from)
      : edge{load(from), load(from + 8), load(from + 16)},
        normal{load(from + 24), load(from + 32), load(from + 40)},
        absent(bits_as_mask(load(from + 48))) {}
  FAIRWAY_INLINE RingEntry(const Vec8& e, const Fan<double>& face)
      : edge(e), normal(face.normal), absent(face.absent) {}
};
constexpr std::size_t kEntry = kLanes * kCurvatureScratch;

/// A corner's share of its face's area.
FAIRWAY_INLINE V8 mixed_share(V8 aa, V8 bb, V8 ab, const Fan<double>& face) {
  const V8 zero = {};
  const V8 at_a = aa - ab;
  const V8 at_b = bb - ab;
  const V8 acute = (aa * at_b + bb * at_a) * face.inverse * 0.125;
  const V8 share = select((at_a < zero) | (at_b < zero), face.twice_area * 0.125, acute);
  return select(ab < zero, face.twice_area * 0.25, share);
}

/// What the first round over the rings finds.
struct RingTotals {
  Vec8 area_vector = {};
  V8 area = {};    ///< mixed
  V8 angles = {};  ///< at the vertex
};

FAIRWAY_INLINE RingTotals first_round(const RingView& rings, const EightRings& eight,
                                      double* scratch) {
  const double least = least_twice_area_squared(1.0);
  const V8 zero = {};
  RingTotals totals;
  RingEntry last(Vec8{zero, zero, zero},
                 Fan<double>({zero, zero, zero}, {zero, zero, zero}, least));
  const Gathered<double> p = gather(rings.positions, eight.vertex);
  Vec8 a = between(p, eight.neighbours(rings, 0));
  V8 aa = dot(a, a);
  for (Index k = 0; k < eight.most_faces; ++k) {
    const Vec8 b = between(p, eight.neighbours(rings, k + 1));
    const V8 bb = dot(b, b);
    const V8 ab = dot(a, b);
    const Fan<double> face(a, b, least);
    const RingEntry entry(a, face);
    entry.put(scratch + kEntry * (std::size_t{k} + 1));
    const Mask<double> ends = eight.ends_with(k);
    last.normal = select<double>(ends, entry.normal, last.normal);
    last.absent = select(ends, entry.absent, last.absent);
    totals.area_vector = totals.area_vector + face.normal * face.twice_area;
    totals.area += select(face.absent, zero, mixed_share(aa, bb, ab, face));
    totals.angles += select(face.absent, zero, angle_of<double>(face.twice_area, ab));
    a = b;
    aa = bb;
  }
  // Before the first edge comes the last face, unless a boundary does.
  last.absent = last.absent | eight.open;
  last.put(scratch);
  return totals;
}

/// A symmetric 2×2 matrix on the tangent plane with the basis u, w, and its eigenvectors.
struct ShapeMatrix {
  Vec8 u, w;
  V8 xx = {}, xy = {}, yy = {};

  FAIRWAY_INLINE explicit ShapeMatrix(const Vec8& n) {
    const V8 one = all(1.0);
    const V8 sign = select(n.z < 0.0, -one, one);
    const V8 a = -one / (sign + n.z);
    const V8 b = n.x * n.y * a;
    u = {one + sign * n.x * n.x * a, sign * b, -sign * n.x};
    w = {b, sign + n.y * n.y * a, -n.y};
  }

  /// ½ ω H_e t tᵗ of the edge `e` with H_e N_e = `h`: t is along e × h, and ω H_e = ⟨N_p, h⟩.
  FAIRWAY_INLINE void add(const Vec8& e, const Vec8& h, const Vec8& n) {
    const V8 zero = {};
    const Vec8 across = cross(e, h);
    const V8 x = dot(across, u);
    const V8 y = dot(across, w);
    const V8 squared = x * x + y * y;
    const V8 scale = select(squared > zero, 0.5 * dot(n, h) / squared, zero);
    xx += scale * x * x;
    xy += scale * x * y;
    yy += scale * y * y;
  }
};

FAIRWAY_INLINE void write(const EightRings& eight, Index some, const CurvatureArrays& out,
                          const V8 (&numbers)[5], const Vec8& dir1, const Vec8& dir2) {
  double* const arrays[] = {out.k1, out.k2, out.mean, out.gaussian, out.predominant};
  for (int j = 0; j < 5; ++j) {
    if (some == kLanes) {
      store(arrays[j] + eight.vertex[0], numbers[j]);
    } else {
      for (Index i = 0; i < some; ++i) {
        arrays[j][eight.vertex[i]] = numbers[j][static_cast<int>(i)];
      }
    }
  }
  for (Index i = 0; i < some; ++i) {
    const int lane = static_cast<int>(i);
    double* one = out.dir1 + 3 * std::size_t{eight.vertex[i]};
    double* two = out.dir2 + 3 * std::size_t{eight.vertex[i]};
    one[0] = dir1.x[lane];
    one[1] = dir1.y[lane];
    one[2] = dir1.z[lane];
    two[0] = dir2.x[lane];
    two[1] = dir2.y[lane];
    two[2] = dir2.z[lane];
  }
}

/// Eigenvalues over the mixed area, eigenvectors, angle defect over the mixed area.
FAIRWAY_INLINE void finish(const EightRings& eight, const RingTotals& totals, const ShapeMatrix& s,
                           Mask<double> has_normal, double per_length, Index some,
                           const CurvatureArrays& out) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const V8 zero = {};
  const V8 mean = 0.5 * (s.xx + s.yy);
  const V8 half = 0.5 * (s.xx - s.yy);
  const V8 radius = square_root(half * half + s.xy * s.xy);
  // Of the two equivalent eigenvector formulas, the one that does not cancel.
  const Mask<double> first = half >= 0.0;
  const V8 signed_rest = select(s.xy < 0.0, half - radius, radius - half);
  const V8 c = select(first, half + radius, magnitude(s.xy));
  const V8 d = select(first, s.xy, signed_rest);
  const V8 squared = c * c + d * d;
  const V8 inverse = select(squared > zero, 1.0 / square_root(squared), zero);
  const V8 cosine = select(squared > zero, c * inverse, zero + 1.0);
  const V8 sine = d * inverse;
  const V8 per_area = select((totals.area > zero) & has_normal, per_length / totals.area, zero);
  const V8 k1 = (mean + radius) * per_area;
  const V8 k2 = (mean - radius) * per_area;
  const V8 defect = select(eight.open | (totals.area <= zero), zero,
                           (kTwoPi - totals.angles) / totals.area * (per_length * per_length));
  const V8 predominant = select(magnitude(k1) >= magnitude(k2), k1, k2);
  const Vec8 none = {zero, zero, zero};
  write(eight, some, out, {k1, k2, 0.5 * (k1 + k2), defect, predominant},
        select<double>(has_normal, s.u * cosine + s.w * sine, none),
        select<double>(has_normal, s.w * cosine - s.u * sine, none));
}

void curvature_of(const RingView& rings, double per_length, Index first, Index last,
                  double* scratch, const CurvatureArrays& out) {
  const V8 zero = {};
  for (Index from = first; from < last; from += kLanes) {
    const EightRings eight(rings, from, last);
    const RingTotals totals = first_round(rings, eight, scratch);
    const V8 squared = dot(totals.area_vector, totals.area_vector);
    const Mask<double> has_normal = squared > zero;
    const Vec8 normal = totals.area_vector * select(has_normal, 1.0 / square_root(squared), zero);
    ShapeMatrix shape(normal);
    RingEntry right(scratch);
    for (Index k = 0; k < eight.most_faces; ++k) {
      const RingEntry left(scratch + kEntry * (std::size_t{k} + 1));
      const Vec8 h = cross(left.edge, left.normal - right.normal);
      const Mask<double> torn = left.absent | right.absent;
      shape.add(left.edge, select<double>(torn, {zero, zero, zero}, h), normal);
      right = left;
    }
    finish(eight, totals, shape, has_normal, per_length, std::min<Index>(kLanes, last - from), out);
  }
}

}  // namespace

CurvatureKernel curvature_kernel() {
  return &curvature_of;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
