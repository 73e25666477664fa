// The shape operator, mixed areas and angle defects of a register's vertices at a time, in two
// rounds over their rings: normals, areas and angles first, then the edges. Sources: Hildebrandt &
// Polthier 2004, eqs. (4), (5); Meyer et al. 2003 (mixed area); Duff et al. 2017 (tangent basis).

#pragma once

#include <algorithm>
#include <limits>

#include "core/curvature_kernel.h"
#include "core/feature_kernels_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

#ifdef __AVX512F__
using Numbers = EightDoubles;
#else
using Numbers = FourDoubles;
#endif
using Flags = Traits<Numbers>::Mask;
using Directions = VectorsOf<Numbers>;
using Triangles = FanOf<Numbers>;
constexpr Index kSome = sizeof(Numbers) / sizeof(double);

FAIRWAY_INLINE Numbers read(const double* from) {
  return from_array<Numbers>(from);
}
FAIRWAY_INLINE void write(double* to, Numbers v) {
  std::memcpy(to, &v, sizeof v);
}

/// A number as a field holds it.
template <class Real>
FAIRWAY_INLINE Real stored(double number) {
  constexpr double kMost = std::numeric_limits<Real>::max();
  return static_cast<Real>(number < -kMost ? -kMost : (number > kMost ? kMost : number));
}

/// The positions of kSome slots.
FAIRWAY_INLINE Directions gather_some(const Quad<double>* quads, const Index* slots) {
#ifdef __AVX512F__
  const Gathered<double> q = gather(quads, slots);
  return {q.x, q.y, q.z};
#elif defined(__AVX2__)
  const auto row = [&](int i) FAIRWAY_LAMBDA { return _mm256_load_pd(&quads[slots[i]].x); };
  const FourByFour q = FourByFour{row(0), row(1), row(2), row(3)}.transposed();
  return {(FourDoubles)q.a, (FourDoubles)q.b, (FourDoubles)q.c};
#else
  Directions out;
  for (int i = 0; i < 4; ++i) {
    out.x[i] = quads[slots[i]].x;
    out.y[i] = quads[slots[i]].y;
    out.z[i] = quads[slots[i]].z;
  }
  return out;
#endif
}

/// Some vertices whose rings may differ in length.
struct SomeRings {
  Index vertex[kSome], first[kSome], valence[kSome], faces[kSome];
  Index most_faces = 0;
  Flags open;

  SomeRings(const RingView& rings, Index from, Index last) {
    std::int64_t is_open[kSome];
    for (Index i = 0; i < kSome; ++i) {
      const Index v = std::min(from + i, last - 1);
      vertex[i] = v;
      first[i] = rings.offsets[v];
      valence[i] = rings.offsets[v + 1] - first[i];
      faces[i] = rings.open[v] != 0 ? valence[i] - 1 : valence[i];
      is_open[i] = rings.open[v] != 0 ? -1 : 0;
      most_faces = std::max(most_faces, faces[i]);
    }
    open = from_array<Flags>(is_open);
  }

  /// Neighbours k; past its end a closed ring goes on with its first, an open one with its last, so
  /// that more faces are absent ones.
  FAIRWAY_INLINE Directions neighbours(const RingView& rings, Index k) const {
    Index slots[kSome];
    for (Index i = 0; i < kSome; ++i) {
      const Index end = faces[i] == valence[i] ? 0 : valence[i] - 1;
      slots[i] = rings.neighbours[first[i] + (k < valence[i] ? k : end)];
    }
    return gather_some(rings.positions, slots);
  }

  /// The lanes whose last face is face k.
  FAIRWAY_INLINE Flags ends_with(Index k) const {
    std::int64_t lanes[kSome];
    for (Index i = 0; i < kSome; ++i) lanes[i] = k + 1 == faces[i] ? -1 : 0;
    return from_array<Flags>(lanes);
  }
};

/// An edge of a ring and the face to its left, as the scratch keeps them.
struct RingEntry {
  Directions edge, normal;
  Flags absent;

  FAIRWAY_INLINE void put(double* scratch) const {
    double* to = scratch;
    for (const Numbers& v : {edge.x, edge.y, edge.z, normal.x, normal.y, normal.z}) {
      write(to, v);
      to += kSome;
    }
    write(to, bits_as_numbers(absent));
  }
  FAIRWAY_INLINE explicit RingEntry(const double* from)
      : edge{read(from), read(from + kSome), read(from + 2 * kSome)},
        normal{read(from + 3 * kSome), read(from + 4 * kSome), read(from + 5 * kSome)},
        absent(bits_as_mask(read(from + 6 * kSome))) {}
  FAIRWAY_INLINE RingEntry(const Directions& e, const Triangles& face)
      : edge(e), normal(face.normal), absent(face.absent) {}
};
constexpr std::size_t kEntry = kSome * kCurvatureScratch;

/// A corner's share of its face's area.
FAIRWAY_INLINE Numbers mixed_share(Numbers aa, Numbers bb, Numbers ab, const Triangles& face) {
  const Numbers zero = {};
  const Numbers at_a = aa - ab;
  const Numbers at_b = bb - ab;
  const Numbers acute = (aa * at_b + bb * at_a) * face.inverse * 0.125;
  const Numbers share = select((at_a < zero) | (at_b < zero), face.twice_area * 0.125, acute);
  return select(ab < zero, face.twice_area * 0.25, share);
}

/// A sum of angles in [0, π], given by cosines and sines times any factor; two share one
/// arctangent, as a product of complex numbers.
class AngleSum {
 public:
  FAIRWAY_INLINE void add(Numbers cosine, Numbers sine) {
    if (waiting_) {
      sum_ += angle_of_two(cosine, sine);
    } else {
      cosine_ = cosine;
      sine_ = sine;
    }
    waiting_ = !waiting_;
  }
  FAIRWAY_INLINE Numbers value() const { return waiting_ ? sum_ + angle_of(sine_, cosine_) : sum_; }

 private:
  FAIRWAY_INLINE Numbers angle_of_two(Numbers cosine, Numbers sine) const {
    constexpr double kTwoPi = 6.28318530717958647692;
    const Numbers zero = {};
    const Numbers real = cosine_ * cosine - sine_ * sine;
    const Numbers imaginary = cosine_ * sine + sine_ * cosine;
    const Numbers angle = angle_of(magnitude(imaginary), real);
    // Two obtuse angles make a reflex one, two others do not, whatever rounding says.
    const Flags obtuse = (cosine_ < zero) & (cosine < zero);
    const Flags acute = (cosine_ >= zero) & (cosine >= zero);
    const Flags reflex = obtuse | ((imaginary < zero) & ~acute);
    return select(reflex, kTwoPi - angle, angle);
  }

  Numbers sum_ = {}, cosine_ = {}, sine_ = {};
  bool waiting_ = false;
};

/// What the first round over the rings finds.
struct RingTotals {
  Directions area_vector = {};
  Numbers area = {};  ///< mixed
  AngleSum angles;    ///< at the vertex
};

FAIRWAY_INLINE RingTotals first_round(const RingView& rings, const SomeRings& some,
                                      double* scratch) {
  const double least = least_twice_area_squared(1.0);
  const Numbers zero = {};
  RingTotals totals;
  RingEntry last(Directions{zero, zero, zero},
                 Triangles({zero, zero, zero}, {zero, zero, zero}, least));
  const Directions p = gather_some(rings.positions, some.vertex);
  Directions a = some.neighbours(rings, 0) - p;
  Numbers aa = dot(a, a);
  for (Index k = 0; k < some.most_faces; ++k) {
    const Directions b = some.neighbours(rings, k + 1) - p;
    const Numbers bb = dot(b, b);
    const Numbers ab = dot(a, b);
    const Triangles face(a, b, least);
    const RingEntry entry(a, face);
    entry.put(scratch + kEntry * (std::size_t{k} + 1));
    const Flags ends = some.ends_with(k);
    last.normal = select(ends, entry.normal, last.normal);
    last.absent = (ends & entry.absent) | (~ends & last.absent);
    totals.area_vector = totals.area_vector + face.normal * face.twice_area;
    totals.area += select(face.absent, zero, mixed_share(aa, bb, ab, face));
    totals.angles.add(select(face.absent, zero + 1.0, ab), face.twice_area);
    a = b;
    aa = bb;
  }
  // Before the first edge comes the last face, unless a boundary does.
  last.absent = last.absent | some.open;
  last.put(scratch);
  return totals;
}

/// A symmetric 2×2 matrix on the tangent plane with the basis u, w, and its eigenvectors.
struct ShapeMatrix {
  Directions u, w;
  Numbers xx = {}, xy = {}, yy = {};

  FAIRWAY_INLINE explicit ShapeMatrix(const Directions& n) {
    const Numbers one = Numbers{} + 1.0;
    const Numbers sign = select(n.z < 0.0, -one, one);
    const Numbers a = -one / (sign + n.z);
    const Numbers b = n.x * n.y * a;
    u = {one + sign * n.x * n.x * a, sign * b, -sign * n.x};
    w = {b, sign + n.y * n.y * a, -n.y};
  }

  /// ½ ω H_e t tᵗ of the edge `e` with H_e N_e = `h`: t is along e × h, and ω H_e = ⟨N_p, h⟩.
  FAIRWAY_INLINE void add(const Directions& e, const Directions& h, const Directions& n) {
    const Numbers zero = {};
    const Directions across = cross(e, h);
    const Numbers x = dot(across, u);
    const Numbers y = dot(across, w);
    const Numbers squared = x * x + y * y;
    const Numbers scale = select(squared > zero, 0.5 * dot(n, h) / squared, zero);
    xx += scale * x * x;
    xy += scale * x * y;
    yy += scale * y * y;
  }
};

template <class Real>
FAIRWAY_INLINE void store(const double* numbers, Index count, Real* to) {
  for (Index i = 0; i < count; ++i) to[i] = stored<Real>(numbers[i]);
}

template <class Real>
FAIRWAY_INLINE void store_directions(const Directions& d, Index count, Real* to) {
  double x[kSome], y[kSome], z[kSome];
  write(x, d.x);
  write(y, d.y);
  write(z, d.z);
  for (Index i = 0; i < count; ++i) {
    to[3 * i] = static_cast<Real>(x[i]);
    to[3 * i + 1] = static_cast<Real>(y[i]);
    to[3 * i + 2] = static_cast<Real>(z[i]);
  }
}

template <class Real>
FAIRWAY_INLINE void write(const SomeRings& some, Index count, const CurvatureArrays<Real>& out,
                          const Numbers (&numbers)[5], const Directions& dir1,
                          const Directions& dir2) {
  const std::size_t at = some.vertex[0];
  Real* const arrays[] = {out.k1, out.k2, out.mean, out.gaussian, out.predominant};
  for (int j = 0; j < 5; ++j) {
    double lanes[kSome];
    write(lanes, numbers[j]);
    // Of a constant count the compiler makes one wide store.
    store(lanes, count == kSome ? kSome : count, arrays[j] + at);
  }
  store_directions(dir1, count, out.dir1 + 3 * at);
  store_directions(dir2, count, out.dir2 + 3 * at);
}

/// Eigenvalues over the mixed area, eigenvectors, angle defect over the mixed area.
template <class Real>
FAIRWAY_INLINE void finish(const SomeRings& some, const RingTotals& totals, const ShapeMatrix& s,
                           Flags has_normal, double per_length, Index count,
                           const CurvatureArrays<Real>& out) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const Numbers zero = {};
  const Numbers mean = 0.5 * (s.xx + s.yy);
  const Numbers half = 0.5 * (s.xx - s.yy);
  const Numbers radius = square_root(half * half + s.xy * s.xy);
  // Of the two equivalent eigenvector formulas, the one that does not cancel.
  const Flags first = half >= 0.0;
  const Numbers signed_rest = select(s.xy < 0.0, half - radius, radius - half);
  const Numbers c = select(first, half + radius, magnitude(s.xy));
  const Numbers d = select(first, s.xy, signed_rest);
  const Numbers squared = c * c + d * d;
  const Numbers inverse = select(squared > zero, 1.0 / square_root(squared), zero);
  const Numbers cosine = select(squared > zero, c * inverse, zero + 1.0);
  const Numbers sine = d * inverse;
  const Numbers per_area =
      select((totals.area > zero) & has_normal, per_length / totals.area, zero);
  const Numbers k1 = (mean + radius) * per_area;
  const Numbers k2 = (mean - radius) * per_area;
  const Numbers defect =
      select(some.open | (totals.area <= zero), zero,
             (kTwoPi - totals.angles.value()) / totals.area * (per_length * per_length));
  const Numbers predominant = select(magnitude(k1) >= magnitude(k2), k1, k2);
  const Directions none = {zero, zero, zero};
  write(some, count, out, {k1, k2, 0.5 * (k1 + k2), defect, predominant},
        select(has_normal, s.u * cosine + s.w * sine, none),
        select(has_normal, s.w * cosine - s.u * sine, none));
}

template <class Real>
void curvature_of(const RingView& rings, double per_length, Index first, Index last,
                  double* scratch, const CurvatureArrays<Real>& out) {
  const Numbers zero = {};
  for (Index from = first; from < last; from += kSome) {
    const SomeRings some(rings, from, last);
    const RingTotals totals = first_round(rings, some, scratch);
    const Numbers squared = dot(totals.area_vector, totals.area_vector);
    const Flags has_normal = squared > zero;
    const Directions normal =
        totals.area_vector * select(has_normal, 1.0 / square_root(squared), zero);
    ShapeMatrix shape(normal);
    RingEntry right(scratch);
    for (Index k = 0; k < some.most_faces; ++k) {
      const RingEntry left(scratch + kEntry * (std::size_t{k} + 1));
      const Directions h = cross(left.edge, left.normal - right.normal);
      const Flags torn = left.absent | right.absent;
      shape.add(left.edge, select(torn, Directions{zero, zero, zero}, h), normal);
      right = left;
    }
    finish(some, totals, shape, has_normal, per_length, std::min<Index>(kSome, last - from), out);
  }
}

}  // namespace

template <class Real>
CurvatureKernel<Real> curvature_kernel() {
  return &curvature_of<Real>;
}
template CurvatureKernel<float> curvature_kernel<float>();
template CurvatureKernel<double> curvature_kernel<double>();

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
