// Eight vertices side by side: numbers, vectors, what is gathered and stored, for the kernels.
// Included by the kernel sources only, each of which names its instruction set in
// FAIRWAY_KERNELS_NAMESPACE. Everything is in that namespace and anonymous: no function compiled
// for a newer processor can take the place of one that an older processor runs.

#pragma once

#include <cstring>
#include <type_traits>

#include <immintrin.h>

#include "core/flow_kernels.h"

#define FAIRWAY_INLINE inline __attribute__((always_inline))
#define FAIRWAY_LAMBDA __attribute__((always_inline))

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// Eight numbers side by side, and the masks that comparing them makes.
template <class Real>
struct LanesOf;
template <>
struct LanesOf<float> {
  typedef float Numbers __attribute__((vector_size(32), aligned(32)));
  typedef std::int32_t Mask __attribute__((vector_size(32), aligned(32)));
};
template <>
struct LanesOf<double> {
  typedef double Numbers __attribute__((vector_size(64), aligned(64)));
  typedef std::int64_t Mask __attribute__((vector_size(64), aligned(64)));
};
template <class Real>
using Lanes = typename LanesOf<Real>::Numbers;
template <class Real>
using Mask = typename LanesOf<Real>::Mask;

template <class Real>
FAIRWAY_INLINE Lanes<Real> all(Real value) {
  return Lanes<Real>{} + value;
}

FAIRWAY_INLINE Lanes<float> square_root(Lanes<float> a) {
#ifdef __AVX__
  return (Lanes<float>)_mm256_sqrt_ps((__m256)a);
#else
  Lanes<float> out;
  for (int i = 0; i < 8; ++i) out[i] = __builtin_sqrtf(a[i]);
  return out;
#endif
}
FAIRWAY_INLINE Lanes<double> square_root(Lanes<double> a) {
#ifdef __AVX512F__
  return (Lanes<double>)_mm512_maskz_sqrt_pd(0xFF, (__m512d)a);
#else
  Lanes<double> out;
  for (int i = 0; i < 8; ++i) out[i] = __builtin_sqrt(a[i]);
  return out;
#endif
}

/// A bit per lane that is set.
FAIRWAY_INLINE unsigned bits_of(Mask<float> m) {
#ifdef __AVX__
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)m));
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (m[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}
FAIRWAY_INLINE unsigned bits_of(Mask<double> m) {
#ifdef __AVX512DQ__
  return _mm512_movepi64_mask((__m512i)m);
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (m[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}

/// The mask of the lanes whose bits are set.
template <class Real>
FAIRWAY_INLINE Mask<Real> mask_of(unsigned bits) {
  Mask<Real> mask;
  for (unsigned i = 0; i < 8; ++i) mask[i] = (bits >> i & 1U) != 0 ? -1 : 0;
  return mask;
}

FAIRWAY_INLINE Lanes<float> magnitude(Lanes<float> a) {
  return (Lanes<float>)((Mask<float>)a & 0x7FFFFFFF);
}
FAIRWAY_INLINE Lanes<double> magnitude(Lanes<double> a) {
  return (Lanes<double>)((Mask<double>)a & 0x7FFFFFFFFFFFFFFF);
}

/// The largest magnitude of many numbers. Bit patterns of magnitudes are ordered like their values,
/// and those of infinity and NaN are the largest, so that neither is lost.
template <class Real>
class LargestMagnitude {
 public:
  FAIRWAY_INLINE void see(Lanes<Real> a) {
    const Mask<Real> bits = (Mask<Real>)magnitude(a);
    most_ = bits > most_ ? bits : most_;
  }
  FAIRWAY_INLINE Real value() const {
    auto most = most_[0];
    for (int i = 1; i < 8; ++i) most = most_[i] > most ? most_[i] : most;
    Real out;
    std::memcpy(&out, &most, sizeof out);
    return out;
  }

 private:
  Mask<Real> most_ = {};
};

/// Eight vectors.
template <class Real>
struct Vectors {
  using V = Lanes<Real>;
  V x, y, z;

  FAIRWAY_INLINE Vectors operator+(const Vectors& b) const { return {x + b.x, y + b.y, z + b.z}; }
  FAIRWAY_INLINE Vectors operator-(const Vectors& b) const { return {x - b.x, y - b.y, z - b.z}; }
  FAIRWAY_INLINE Vectors operator*(V s) const { return {x * s, y * s, z * s}; }
};
template <class Real>
FAIRWAY_INLINE Lanes<Real> dot(const Vectors<Real>& a, const Vectors<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
FAIRWAY_INLINE Vectors<Real> cross(const Vectors<Real>& a, const Vectors<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// arctan(t) / t as a polynomial in z = t² for |t| ≤ tan(π/8): Chebyshev approximations with errors
/// of 6e-10 and 5e-18.
FAIRWAY_INLINE Lanes<float> arctangent_ratio(Lanes<float> z) {
  constexpr float c[] = {0.99999999939F,  -0.33333307493F, 0.19998210797F,
                         -0.14239982907F, 0.10572814385F,  -0.06033241468F};
  Lanes<float> sum = all(c[5]);
  for (int i = 4; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}
FAIRWAY_INLINE Lanes<double> arctangent_ratio(Lanes<double> z) {
  constexpr double c[] = {1.0,
                          -0.33333333333333143,
                          0.199999999999463,
                          -0.14285714279750261,
                          0.11111110768174225,
                          -0.090908974327320272,
                          0.076920557002574996,
                          -0.066630622524228189,
                          0.058476330961165911,
                          -0.050383047495815569,
                          0.038042041250864196,
                          -0.017884926189723441};
  Lanes<double> sum = all(c[11]);
  for (int i = 10; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}

/// The angle in [0, π] whose sine and cosine stand in the ratio of `sine` ≥ 0 and `cosine`; 0 where
/// both vanish.
template <class Real>
FAIRWAY_INLINE Lanes<Real> angle_of(Lanes<Real> sine, Lanes<Real> cosine) {
  using V = Lanes<Real>;
  constexpr Real kPi = static_cast<Real>(3.14159265358979323846);
  constexpr Real kTangentOfEighth = static_cast<Real>(0.41421356237309504880);
  const V x = magnitude(cosine);
  const Mask<Real> steep = sine > x;
  const V small = steep ? x : sine;
  const V large = steep ? sine : x;
  const Mask<Real> beyond = small > large * kTangentOfEighth;
  const V over = beyond ? small - large : small;
  const V under = beyond ? small + large : large;
  const V t = under > 0 ? over / under : V{};
  V angle = t * arctangent_ratio(t * t);
  angle = beyond ? angle + kPi / 4 : angle;
  angle = steep ? kPi / 2 - angle : angle;
  return cosine < 0 ? kPi - angle : angle;
}

template <class T>
using Stored = Quad<typename StoredCoordinate<T>::Type>;

/// Eight stored quads, number by number.
template <class Real>
struct Gathered;
template <>
struct Gathered<float> {
  Mask<float> x, y, z, w;
};
template <>
struct Gathered<double> {
  Lanes<double> x, y, z, w;
};

FAIRWAY_INLINE Gathered<float> gather(const Stored<float>* positions, const Index* slots) {
#ifdef __AVX2__
  const auto pair = [&](int low, int high) {
    const auto* a = reinterpret_cast<const __m128i*>(positions + slots[low]);
    const auto* b = reinterpret_cast<const __m128i*>(positions + slots[high]);
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_load_si128(a)), _mm_load_si128(b), 1);
  };
  const __m256i r0 = pair(0, 4);
  const __m256i r1 = pair(1, 5);
  const __m256i r2 = pair(2, 6);
  const __m256i r3 = pair(3, 7);
  const __m256i xy01 = _mm256_unpacklo_epi32(r0, r1);
  const __m256i xy23 = _mm256_unpacklo_epi32(r2, r3);
  const __m256i z01 = _mm256_unpackhi_epi32(r0, r1);
  const __m256i z23 = _mm256_unpackhi_epi32(r2, r3);
  return {(Mask<float>)_mm256_unpacklo_epi64(xy01, xy23),
          (Mask<float>)_mm256_unpackhi_epi64(xy01, xy23),
          (Mask<float>)_mm256_unpacklo_epi64(z01, z23),
          (Mask<float>)_mm256_unpackhi_epi64(z01, z23)};
#else
  Gathered<float> out;
  for (int i = 0; i < 8; ++i) {
    Stored<float> p;
    std::memcpy(&p, positions + slots[i], sizeof p);
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.z[i] = p.z;
    out.w[i] = p.w;
  }
  return out;
#endif
}
FAIRWAY_INLINE Gathered<double> gather(const Stored<double>* positions, const Index* slots) {
#ifdef __AVX512F__
  const auto pair = [&](int low, int high) {
    const __m512d a = _mm512_castpd256_pd512(_mm256_load_pd(&positions[slots[low]].x));
    return _mm512_maskz_insertf64x4(0xFF, a, _mm256_load_pd(&positions[slots[high]].x), 1);
  };
  // Masked forms throughout: g++ 12 warns of the others' undefined registers.
  // Each half holds two quads after unpacking: (x0 x1 z0 z1), (y0 y1 w0 w1) and so on.
  const __m512d r04 = pair(0, 4);
  const __m512d r15 = pair(1, 5);
  const __m512d r26 = pair(2, 6);
  const __m512d r37 = pair(3, 7);
  const __m512d xz01 = _mm512_maskz_unpacklo_pd(0xFF, r04, r15);
  const __m512d yw01 = _mm512_maskz_unpackhi_pd(0xFF, r04, r15);
  const __m512d xz23 = _mm512_maskz_unpacklo_pd(0xFF, r26, r37);
  const __m512d yw23 = _mm512_maskz_unpackhi_pd(0xFF, r26, r37);
  const __m512i low = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0);
  const __m512i high = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
  return {(Lanes<double>)_mm512_permutex2var_pd(xz01, low, xz23),
          (Lanes<double>)_mm512_permutex2var_pd(yw01, low, yw23),
          (Lanes<double>)_mm512_permutex2var_pd(xz01, high, xz23),
          (Lanes<double>)_mm512_permutex2var_pd(yw01, high, yw23)};
#else
  Gathered<double> out;
  for (int i = 0; i < 8; ++i) {
    const Stored<double>& p = positions[slots[i]];
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.z[i] = p.z;
    out.w[i] = p.w;
  }
  return out;
#endif
}

/// Eight quads of numbers.
template <class Real>
struct Quads {
  Vectors<Real> xyz;
  Lanes<Real> w;
};
template <class Real>
FAIRWAY_INLINE Quads<Real> gather_quads(const Quad<Real>* values, const Index* slots) {
  const auto* stored = reinterpret_cast<const Stored<Real>*>(values);
  const Gathered<Real> q = gather(stored, slots);
  using V = Lanes<Real>;
  return {{(V)q.x, (V)q.y, (V)q.z}, (V)q.w};
}

/// q − p in stored units: exact differences of fixed-point coordinates.
FAIRWAY_INLINE Vectors<float> between(const Gathered<float>& p, const Gathered<float>& q) {
  return {__builtin_convertvector(q.x - p.x, Lanes<float>),
          __builtin_convertvector(q.y - p.y, Lanes<float>),
          __builtin_convertvector(q.z - p.z, Lanes<float>)};
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

FAIRWAY_INLINE Lanes<float> gather_values(const float* values, const Index* slots) {
  return Lanes<float>{values[slots[0]], values[slots[1]], values[slots[2]], values[slots[3]],
                      values[slots[4]], values[slots[5]], values[slots[6]], values[slots[7]]};
}
FAIRWAY_INLINE Lanes<double> gather_values(const double* values, const Index* slots) {
  return Lanes<double>{values[slots[0]], values[slots[1]], values[slots[2]], values[slots[3]],
                       values[slots[4]], values[slots[5]], values[slots[6]], values[slots[7]]};
}

template <class Real>
FAIRWAY_INLINE Lanes<Real> load(const Real* from) {
  Lanes<Real> out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
template <class Real>
FAIRWAY_INLINE void store(Real* out, Lanes<Real> v) {
  std::memcpy(out, &v, sizeof v);
}

template <class Real>
FAIRWAY_INLINE void store_quads(Quad<Real>* out, const Vectors<Real>& v, Lanes<Real> w) {
  for (int i = 0; i < 8; ++i) {
    const Quad<Real> q = {v.x[i], v.y[i], v.z[i], w[i]};
    std::memcpy(out + i, &q, sizeof q);
  }
}
#ifdef __AVX__
template <>
FAIRWAY_INLINE void store_quads<float>(Quad<float>* out, const Vectors<float>& v, Lanes<float> w) {
  const __m256 xy_low = _mm256_unpacklo_ps((__m256)v.x, (__m256)v.y);
  const __m256 xy_high = _mm256_unpackhi_ps((__m256)v.x, (__m256)v.y);
  const __m256 zw_low = _mm256_unpacklo_ps((__m256)v.z, (__m256)w);
  const __m256 zw_high = _mm256_unpackhi_ps((__m256)v.z, (__m256)w);
  const __m256 r04 = _mm256_shuffle_ps(xy_low, zw_low, 0x44);
  const __m256 r15 = _mm256_shuffle_ps(xy_low, zw_low, 0xEE);
  const __m256 r26 = _mm256_shuffle_ps(xy_high, zw_high, 0x44);
  const __m256 r37 = _mm256_shuffle_ps(xy_high, zw_high, 0xEE);
  auto* to = reinterpret_cast<float*>(out);
  _mm256_storeu_ps(to, _mm256_permute2f128_ps(r04, r15, 0x20));
  _mm256_storeu_ps(to + 8, _mm256_permute2f128_ps(r26, r37, 0x20));
  _mm256_storeu_ps(to + 16, _mm256_permute2f128_ps(r04, r15, 0x31));
  _mm256_storeu_ps(to + 24, _mm256_permute2f128_ps(r26, r37, 0x31));
}
#endif

/// Stored units, rounded. What does not fit wraps around: whoever moves looks at the magnitude.
FAIRWAY_INLINE Mask<float> rounded(Lanes<float> a) {
#ifdef __AVX__
  return (Mask<float>)_mm256_cvtps_epi32((__m256)a);
#else
  Mask<float> out;
  for (int i = 0; i < 8; ++i) {
    const bool fits = a[i] > -2e9F && a[i] < 2e9F;
    out[i] = fits ? static_cast<std::int32_t>(__builtin_lrintf(a[i])) : 0;
  }
  return out;
#endif
}

/// a − b, wrapping around.
FAIRWAY_INLINE Mask<float> less(Mask<float> a, Mask<float> b) {
  typedef std::uint32_t Unsigned __attribute__((vector_size(32), aligned(32)));
  return (Mask<float>)((Unsigned)a - (Unsigned)b);
}

/// Eight displacements in stored units.
FAIRWAY_INLINE void store_rounded(Stored<float>* out, const Vectors<float>& by) {
  store_quads<float>(
      reinterpret_cast<Quad<float>*>(out),
      {(Lanes<float>)rounded(by.x), (Lanes<float>)rounded(by.y), (Lanes<float>)rounded(by.z)},
      Lanes<float>{});
}
FAIRWAY_INLINE void store_rounded(Stored<double>* out, const Vectors<double>& by) {
  store_quads<double>(out, by, Lanes<double>{});
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
  p = {p.x + by.x, p.y + by.y, p.z + by.z, 0};
}

/// p − by, in stored units, into eight slots.
FAIRWAY_INLINE void store_moved(Stored<float>* out, const Gathered<float>& p,
                                const Vectors<float>& by, LargestMagnitude<float>& largest) {
  largest.see(__builtin_convertvector(p.x, Lanes<float>) - by.x);
  largest.see(__builtin_convertvector(p.y, Lanes<float>) - by.y);
  largest.see(__builtin_convertvector(p.z, Lanes<float>) - by.z);
  store_quads<float>(
      reinterpret_cast<Quad<float>*>(out),
      {(Lanes<float>)less(p.x, rounded(by.x)), (Lanes<float>)less(p.y, rounded(by.y)),
       (Lanes<float>)less(p.z, rounded(by.z))},
      Lanes<float>{});
}
FAIRWAY_INLINE void store_moved(Stored<double>* out, const Gathered<double>& p,
                                const Vectors<double>& by, LargestMagnitude<double>& largest) {
  const Vectors<double> to = {p.x - by.x, p.y - by.y, p.z - by.z};
  largest.see(to.x);
  largest.see(to.y);
  largest.see(to.z);
  store_quads<double>(out, to, Lanes<double>{});
}

/// Looks at the coordinates of eight slots.
FAIRWAY_INLINE void see_all(const Stored<float>* positions, const Index* slots,
                            LargestMagnitude<float>& largest) {
  const Gathered<float> p = gather(positions, slots);
  for (const Mask<float>& c : {p.x, p.y, p.z}) {
    largest.see(__builtin_convertvector(c, Lanes<float>));
  }
}
FAIRWAY_INLINE void see_all(const Stored<double>* positions, const Index* slots,
                            LargestMagnitude<double>& largest) {
  const Gathered<double> p = gather(positions, slots);
  for (const Lanes<double>& c : {p.x, p.y, p.z}) largest.see(c);
}

/// The lowest bit of f says "feature vertex".
FAIRWAY_INLINE Lanes<float> clear_lowest_bit(Lanes<float> f) {
  return (Lanes<float>)((Mask<float>)f & ~1);
}
FAIRWAY_INLINE Lanes<double> clear_lowest_bit(Lanes<double> f) {
  return (Lanes<double>)((Mask<double>)f & ~std::int64_t{1});
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
