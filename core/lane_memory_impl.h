// What the kernels gather and store: positions in fixed point or double, quads and values of slots.
// See lanes_impl.h for the rules.

#pragma once

#include "core/flow_kernels.h"
#include "core/lanes_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

template <class T>
using Stored = Quad<typename StoredCoordinate<T>::Type>;

/// Eight stored quads, number by number.
template <class Real>
struct Gathered {
  using V = std::conditional_t<std::is_same_v<Real, float>, EightInts, EightDoubles>;
  V x, y, z, w;
};

/// The plain way.
template <class Real>
FAIRWAY_INLINE Gathered<Real> gather_one_by_one(const Stored<Real>* quads, const Index* slots) {
  using V = typename Gathered<Real>::V;
  typename StoredCoordinate<Real>::Type x[8], y[8], z[8], w[8];
  for (int i = 0; i < 8; ++i) {
    Stored<Real> q;
    std::memcpy(&q, quads + slots[i], sizeof q);
    x[i] = q.x;
    y[i] = q.y;
    z[i] = q.z;
    w[i] = q.w;
  }
  return {from_array<V>(x), from_array<V>(y), from_array<V>(z), from_array<V>(w)};
}

#ifdef __AVX2__
/// Rows become columns.
struct FourByFour {
  __m256d a, b, c, d;
  FAIRWAY_INLINE FourByFour transposed() const {
    const __m256d ab_low = _mm256_unpacklo_pd(a, b);
    const __m256d ab_high = _mm256_unpackhi_pd(a, b);
    const __m256d cd_low = _mm256_unpacklo_pd(c, d);
    const __m256d cd_high = _mm256_unpackhi_pd(c, d);
    return {_mm256_permute2f128_pd(ab_low, cd_low, 0x20),
            _mm256_permute2f128_pd(ab_high, cd_high, 0x20),
            _mm256_permute2f128_pd(ab_low, cd_low, 0x31),
            _mm256_permute2f128_pd(ab_high, cd_high, 0x31)};
  }
};
FAIRWAY_INLINE EightDoubles join(__m256d low, __m256d high) {
#ifdef __AVX512F__
  return __builtin_shufflevector((FourDoubles)low, (FourDoubles)high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return {(FourDoubles)low, (FourDoubles)high};
#endif
}
FAIRWAY_INLINE __m256d low_half(EightDoubles v) {
#ifdef __AVX512F__
  return (__m256d)__builtin_shufflevector(v, v, 0, 1, 2, 3);
#else
  return (__m256d)v.low;
#endif
}
FAIRWAY_INLINE __m256d high_half(EightDoubles v) {
#ifdef __AVX512F__
  return (__m256d)__builtin_shufflevector(v, v, 4, 5, 6, 7);
#else
  return (__m256d)v.high;
#endif
}
#endif

FAIRWAY_INLINE Gathered<float> gather(const Stored<float>* quads, const Index* slots) {
#ifdef __AVX2__
  const auto pair = [&](int low, int high) FAIRWAY_LAMBDA {
    const auto* a = reinterpret_cast<const __m128i*>(quads + slots[low]);
    const auto* b = reinterpret_cast<const __m128i*>(quads + slots[high]);
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_load_si128(a)), _mm_load_si128(b), 1);
  };
  const __m256i r0 = pair(0, 4);
  const __m256i r1 = pair(1, 5);
  const __m256i r2 = pair(2, 6);
  const __m256i r3 = pair(3, 7);
  const __m256i xy01 = _mm256_unpacklo_epi32(r0, r1);
  const __m256i xy23 = _mm256_unpacklo_epi32(r2, r3);
  const __m256i zw01 = _mm256_unpackhi_epi32(r0, r1);
  const __m256i zw23 = _mm256_unpackhi_epi32(r2, r3);
  return {
      (EightInts)_mm256_unpacklo_epi64(xy01, xy23), (EightInts)_mm256_unpackhi_epi64(xy01, xy23),
      (EightInts)_mm256_unpacklo_epi64(zw01, zw23), (EightInts)_mm256_unpackhi_epi64(zw01, zw23)};
#else
  return gather_one_by_one<float>(quads, slots);
#endif
}
FAIRWAY_INLINE Gathered<double> gather(const Stored<double>* quads, const Index* slots) {
#ifdef __AVX2__
  const auto row = [&](int i) FAIRWAY_LAMBDA { return _mm256_load_pd(&quads[slots[i]].x); };
  const FourByFour low = FourByFour{row(0), row(1), row(2), row(3)}.transposed();
  const FourByFour high = FourByFour{row(4), row(5), row(6), row(7)}.transposed();
  return {join(low.a, high.a), join(low.b, high.b), join(low.c, high.c), join(low.d, high.d)};
#else
  return gather_one_by_one<double>(quads, slots);
#endif
}

/// Eight quads of numbers.
template <class Real>
struct Quads {
  Vectors<Real> xyz;
  Lanes<Real> w;
};
FAIRWAY_INLINE Quads<float> gather_quads(const Quad<float>* values, const Index* slots) {
  const Gathered<float> q = gather(reinterpret_cast<const Stored<float>*>(values), slots);
  return {{bits_as_numbers(q.x), bits_as_numbers(q.y), bits_as_numbers(q.z)}, bits_as_numbers(q.w)};
}
FAIRWAY_INLINE Quads<double> gather_quads(const Quad<double>* values, const Index* slots) {
  const Gathered<double> q = gather(values, slots);
  return {{q.x, q.y, q.z}, q.w};
}

/// q − p in stored units: exact differences of fixed-point coordinates.
FAIRWAY_INLINE Vectors<float> between(const Gathered<float>& p, const Gathered<float>& q) {
  return {__builtin_convertvector(q.x - p.x, EightFloats),
          __builtin_convertvector(q.y - p.y, EightFloats),
          __builtin_convertvector(q.z - p.z, EightFloats)};
}
FAIRWAY_INLINE Vectors<double> between(const Gathered<double>& p, const Gathered<double>& q) {
  return {q.x - p.x, q.y - p.y, q.z - p.z};
}

/// The eight slots of a slice.
struct OwnSlots {
  Index slots[8];
  FAIRWAY_INLINE explicit OwnSlots(Index slice) {
    for (Index i = 0; i < kLanes; ++i) slots[i] = kLanes * slice + i;
  }
};

/// The positions of a slice's own eight slots.
template <class Real>
FAIRWAY_INLINE Gathered<Real> own(const Stored<Real>* positions, Index slice) {
  return gather(positions, OwnSlots(slice).slots);
}
template <class Real>
FAIRWAY_INLINE Quads<Real> own_quads(const Quad<Real>* values, Index slice) {
  return gather_quads(values, OwnSlots(slice).slots);
}

FAIRWAY_INLINE EightFloats gather_values(const float* values, const Index* slots) {
  return EightFloats{values[slots[0]], values[slots[1]], values[slots[2]], values[slots[3]],
                     values[slots[4]], values[slots[5]], values[slots[6]], values[slots[7]]};
}
FAIRWAY_INLINE EightDoubles gather_values(const double* values, const Index* slots) {
  const FourDoubles low = {values[slots[0]], values[slots[1]], values[slots[2]], values[slots[3]]};
  const FourDoubles high = {values[slots[4]], values[slots[5]], values[slots[6]], values[slots[7]]};
#ifdef __AVX512F__
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return {low, high};
#endif
}

/// Eight quads into a row.
template <class T, class V>
FAIRWAY_INLINE void store_one_by_one(Quad<T>* out, V x, V y, V z, V w) {
  for (int i = 0; i < 8; ++i) {
    const Quad<T> q = {x[i], y[i], z[i], w[i]};
    std::memcpy(out + i, &q, sizeof q);
  }
}
template <class T>
FAIRWAY_INLINE void store_fours(Quad<T>* out, EightFloats x, EightFloats y, EightFloats z,
                                EightFloats w) {
#ifdef __AVX__
  const __m256 xy_low = _mm256_unpacklo_ps((__m256)x, (__m256)y);
  const __m256 xy_high = _mm256_unpackhi_ps((__m256)x, (__m256)y);
  const __m256 zw_low = _mm256_unpacklo_ps((__m256)z, (__m256)w);
  const __m256 zw_high = _mm256_unpackhi_ps((__m256)z, (__m256)w);
  const __m256 r04 = _mm256_shuffle_ps(xy_low, zw_low, 0x44);
  const __m256 r15 = _mm256_shuffle_ps(xy_low, zw_low, 0xEE);
  const __m256 r26 = _mm256_shuffle_ps(xy_high, zw_high, 0x44);
  const __m256 r37 = _mm256_shuffle_ps(xy_high, zw_high, 0xEE);
  auto* to = reinterpret_cast<float*>(out);
  _mm256_storeu_ps(to, _mm256_permute2f128_ps(r04, r15, 0x20));
  _mm256_storeu_ps(to + 8, _mm256_permute2f128_ps(r26, r37, 0x20));
  _mm256_storeu_ps(to + 16, _mm256_permute2f128_ps(r04, r15, 0x31));
  _mm256_storeu_ps(to + 24, _mm256_permute2f128_ps(r26, r37, 0x31));
#else
  if constexpr (std::is_same_v<T, float>) {
    store_one_by_one(out, x, y, z, w);
  } else {
    store_one_by_one(out, bits_as_mask(x), bits_as_mask(y), bits_as_mask(z), bits_as_mask(w));
  }
#endif
}
FAIRWAY_INLINE void store_quads(Quad<float>* out, const Vectors<float>& v, EightFloats w) {
  store_fours(out, v.x, v.y, v.z, w);
}
FAIRWAY_INLINE void store_quads(Quad<double>* out, const Vectors<double>& v, EightDoubles w) {
#ifdef __AVX2__
  const auto four = [](double* to, const FourByFour& columns) FAIRWAY_LAMBDA {
    const FourByFour rows = columns.transposed();
    _mm256_storeu_pd(to, rows.a);
    _mm256_storeu_pd(to + 4, rows.b);
    _mm256_storeu_pd(to + 8, rows.c);
    _mm256_storeu_pd(to + 12, rows.d);
  };
  four(&out[0].x, {low_half(v.x), low_half(v.y), low_half(v.z), low_half(w)});
  four(&out[4].x, {high_half(v.x), high_half(v.y), high_half(v.z), high_half(w)});
#else
  store_one_by_one(out, v.x, v.y, v.z, w);
#endif
}

/// Stored units, rounded. What does not fit wraps around: whoever moves looks at the magnitude.
FAIRWAY_INLINE EightInts rounded(EightFloats a) {
#ifdef __AVX__
  return (EightInts)_mm256_cvtps_epi32((__m256)a);
#else
  EightInts out;
  for (int i = 0; i < 8; ++i) {
    const bool fits = a[i] > -2e9F && a[i] < 2e9F;
    out[i] = fits ? static_cast<std::int32_t>(__builtin_lrintf(a[i])) : 0;
  }
  return out;
#endif
}

/// a − b, wrapping around.
FAIRWAY_INLINE EightInts less(EightInts a, EightInts b) {
  typedef std::uint32_t Unsigned __attribute__((vector_size(32)));
  return (EightInts)((Unsigned)a - (Unsigned)b);
}

FAIRWAY_INLINE void store_ints(Stored<float>* out, EightInts x, EightInts y, EightInts z,
                               EightFloats w = EightFloats{}) {
  store_fours(out, bits_as_numbers(x), bits_as_numbers(y), bits_as_numbers(z), w);
}

/// Eight displacements in stored units.
FAIRWAY_INLINE void store_rounded(Stored<float>* out, const Vectors<float>& by) {
  store_ints(out, rounded(by.x), rounded(by.y), rounded(by.z));
}
FAIRWAY_INLINE void store_rounded(Stored<double>* out, const Vectors<double>& by) {
  store_quads(out, by, EightDoubles{});
}

FAIRWAY_INLINE void add(Stored<float>& p, const Stored<float>& by) {
  typedef std::uint32_t Four __attribute__((vector_size(16)));
  Four a;
  Four b;
  std::memcpy(&a, &p, sizeof a);
  std::memcpy(&b, &by, sizeof b);
  a += b;
  std::memcpy(&p, &a, sizeof a);
}
FAIRWAY_INLINE void add(Stored<double>& p, const Stored<double>& by) {
  p = {p.x + by.x, p.y + by.y, p.z + by.z, p.w};
}

/// p − by, in stored units, into eight slots, and the bits of w.
FAIRWAY_INLINE void store_moved(Stored<float>* out, const Gathered<float>& p,
                                const Vectors<float>& by, EightFloats w,
                                LargestMagnitude<float>& largest) {
  largest.see(__builtin_convertvector(p.x, EightFloats) - by.x);
  largest.see(__builtin_convertvector(p.y, EightFloats) - by.y);
  largest.see(__builtin_convertvector(p.z, EightFloats) - by.z);
  store_ints(out, less(p.x, rounded(by.x)), less(p.y, rounded(by.y)), less(p.z, rounded(by.z)), w);
}
FAIRWAY_INLINE void store_moved(Stored<double>* out, const Gathered<double>& p,
                                const Vectors<double>& by, EightDoubles w,
                                LargestMagnitude<double>& largest) {
  const Vectors<double> to = {p.x - by.x, p.y - by.y, p.z - by.z};
  largest.see(to.x);
  largest.see(to.y);
  largest.see(to.z);
  store_quads(out, to, w);
}

/// The w of eight slots as store_moved() left them.
FAIRWAY_INLINE EightFloats gather_w(const Stored<float>* quads, const Index* slots) {
  const auto w = [&](int i) FAIRWAY_LAMBDA { return quads[slots[i]].w; };
  return bits_as_numbers(EightInts{w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7)});
}
FAIRWAY_INLINE EightDoubles gather_w(const Stored<double>* quads, const Index* slots) {
  return gather(quads, slots).w;
}

/// The lowest bit of f says "feature vertex": that bit alone, or f without it.
template <class Real>
FAIRWAY_INLINE Mask<Real> kind_of(Lanes<Real> f) {
  return bits_as_mask(f) & 1;
}
template <class Real>
FAIRWAY_INLINE Lanes<Real> with_kind(Lanes<Real> f, Mask<Real> kind) {
  return bits_as_numbers((bits_as_mask(f) & -2) | kind);
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
