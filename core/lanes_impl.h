// Eight numbers side by side, for the kernels. Included by the kernel sources only, each of which
// names its instruction set in FAIRWAY_KERNELS_NAMESPACE. Everything is in that namespace and
// anonymous: no function compiled for a newer processor can take the place of one that an older
// processor runs.

#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include <immintrin.h>

#define FAIRWAY_INLINE inline __attribute__((always_inline))
#define FAIRWAY_LAMBDA __attribute__((always_inline))

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

typedef float EightFloats __attribute__((vector_size(32)));
typedef std::int32_t EightInts __attribute__((vector_size(32)));
typedef float FourFloats __attribute__((vector_size(16)));
typedef double FourDoubles __attribute__((vector_size(32)));
typedef std::int64_t FourLongs __attribute__((vector_size(32)));

#ifdef __AVX512F__
typedef double EightDoubles __attribute__((vector_size(64)));
typedef std::int64_t EightLongs __attribute__((vector_size(64)));
#else
/// Eight numbers where registers hold four: compilers keep wider vectors in memory.
template <class Four>
struct Halves {
  using Scalar = std::remove_cvref_t<decltype(Four{}[0])>;
  Four low, high;

  FAIRWAY_INLINE Scalar operator[](int i) const { return i < 4 ? low[i] : high[i - 4]; }
  FAIRWAY_INLINE Halves& operator+=(const Halves& b) {
    low += b.low;
    high += b.high;
    return *this;
  }
  FAIRWAY_INLINE Halves operator-() const { return {-low, -high}; }
  FAIRWAY_INLINE Halves operator~() const { return {~low, ~high}; }
};
template <class Four>
FAIRWAY_INLINE Halves<Four> halves(Four low, Four high) {
  return {low, high};
}
// The arithmetic and comparisons of compiler vectors, with scalars on either side.
#define FAIRWAY_HALVES(op)                                                            \
  template <class F>                                                                  \
  FAIRWAY_INLINE auto operator op(const Halves<F>& a, const Halves<F>& b) {           \
    return halves(a.low op b.low, a.high op b.high);                                  \
  }                                                                                   \
  template <class F>                                                                  \
  FAIRWAY_INLINE auto operator op(const Halves<F>& a, typename Halves<F>::Scalar b) { \
    return halves(a.low op b, a.high op b);                                           \
  }                                                                                   \
  template <class F>                                                                  \
  FAIRWAY_INLINE auto operator op(typename Halves<F>::Scalar a, const Halves<F>& b) { \
    return halves(a op b.low, a op b.high);                                           \
  }
FAIRWAY_HALVES(+)
FAIRWAY_HALVES(-)
FAIRWAY_HALVES(*)
FAIRWAY_HALVES(/)
FAIRWAY_HALVES(&)
FAIRWAY_HALVES(|)
#undef FAIRWAY_HALVES
// Compilers do not agree which 64-bit integers a comparison makes.
#define FAIRWAY_COMPARE_HALVES(op)                                                                 \
  template <class F>                                                                               \
  FAIRWAY_INLINE Halves<FourLongs> operator op(const Halves<F>& a, const Halves<F>& b) {           \
    return {(FourLongs)(a.low op b.low), (FourLongs)(a.high op b.high)};                           \
  }                                                                                                \
  template <class F>                                                                               \
  FAIRWAY_INLINE Halves<FourLongs> operator op(const Halves<F>& a, typename Halves<F>::Scalar b) { \
    return {(FourLongs)(a.low op b), (FourLongs)(a.high op b)};                                    \
  }
FAIRWAY_COMPARE_HALVES(<)
FAIRWAY_COMPARE_HALVES(>)
FAIRWAY_COMPARE_HALVES(<=)
FAIRWAY_COMPARE_HALVES(>=)
FAIRWAY_COMPARE_HALVES(==)
FAIRWAY_COMPARE_HALVES(!=)
#undef FAIRWAY_COMPARE_HALVES
typedef Halves<FourDoubles> EightDoubles;
typedef Halves<FourLongs> EightLongs;
#endif

/// Eight numbers, and the masks that comparing them makes.
template <class Real>
using Lanes = std::conditional_t<std::is_same_v<Real, float>, EightFloats, EightDoubles>;
template <class Real>
using Mask = std::conditional_t<std::is_same_v<Real, float>, EightInts, EightLongs>;

/// The mask and the scalar that go with some lanes.
template <class V>
struct Traits;
template <>
struct Traits<EightFloats> {
  using Mask = EightInts;
  using Scalar = float;
};
template <>
struct Traits<EightDoubles> {
  using Mask = EightLongs;
  using Scalar = double;
};
template <>
struct Traits<FourDoubles> {
  using Mask = FourLongs;
  using Scalar = double;
};

/// a where the mask is set, b elsewhere.
FAIRWAY_INLINE EightFloats select(EightInts mask, EightFloats a, EightFloats b) {
  return mask ? a : b;
}
FAIRWAY_INLINE EightInts select(EightInts mask, EightInts a, EightInts b) {
  return mask ? a : b;
}

FAIRWAY_INLINE EightInts bits_as_mask(EightFloats a) {
  return (EightInts)a;
}
FAIRWAY_INLINE EightFloats bits_as_numbers(EightInts a) {
  return (EightFloats)a;
}

FAIRWAY_INLINE EightFloats square_root(EightFloats a) {
#ifdef __AVX__
  return (EightFloats)_mm256_sqrt_ps((__m256)a);
#else
  EightFloats out;
  for (int i = 0; i < 8; ++i) out[i] = __builtin_sqrtf(a[i]);
  return out;
#endif
}

/// The smaller of each two; the second where the first is not a number.
FAIRWAY_INLINE EightFloats smaller(EightFloats a, EightFloats b) {
#ifdef __AVX__
  return (EightFloats)_mm256_min_ps((__m256)a, (__m256)b);
#else
  return select(a < b, a, b);
#endif
}

/// A bit per lane that is set.
FAIRWAY_INLINE unsigned bits_of(EightInts m) {
#ifdef __AVX__
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)m));
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (m[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}

FAIRWAY_INLINE FourDoubles select(FourLongs mask, FourDoubles a, FourDoubles b) {
  return mask ? a : b;
}
FAIRWAY_INLINE FourLongs bits_as_mask(FourDoubles a) {
  return (FourLongs)a;
}
FAIRWAY_INLINE FourDoubles bits_as_numbers(FourLongs a) {
  return (FourDoubles)a;
}
FAIRWAY_INLINE FourDoubles square_root(FourDoubles a) {
#ifdef __AVX__
  return (FourDoubles)_mm256_sqrt_pd((__m256d)a);
#else
  for (int i = 0; i < 4; ++i) a[i] = __builtin_sqrt(a[i]);
  return a;
#endif
}
#ifdef __AVX512F__
FAIRWAY_INLINE EightDoubles select(EightLongs mask, EightDoubles a, EightDoubles b) {
  return mask ? a : b;
}
FAIRWAY_INLINE EightLongs select(EightLongs mask, EightLongs a, EightLongs b) {
  return mask ? a : b;
}
FAIRWAY_INLINE EightLongs bits_as_mask(EightDoubles a) {
  return (EightLongs)a;
}
FAIRWAY_INLINE EightDoubles bits_as_numbers(EightLongs a) {
  return (EightDoubles)a;
}
FAIRWAY_INLINE EightDoubles square_root(EightDoubles a) {
  // Masked: g++ 12 warns of an undefined register in the plain form.
  return (EightDoubles)_mm512_maskz_sqrt_pd(0xFF, (__m512d)a);
}
FAIRWAY_INLINE unsigned bits_of(EightLongs m) {
  return _mm512_movepi64_mask((__m512i)m);
}
#else
FAIRWAY_INLINE EightDoubles select(EightLongs mask, EightDoubles a, EightDoubles b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}
FAIRWAY_INLINE EightLongs select(EightLongs mask, EightLongs a, EightLongs b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}
FAIRWAY_INLINE EightLongs bits_as_mask(EightDoubles a) {
  return {(FourLongs)a.low, (FourLongs)a.high};
}
FAIRWAY_INLINE EightDoubles bits_as_numbers(EightLongs a) {
  return {(FourDoubles)a.low, (FourDoubles)a.high};
}
FAIRWAY_INLINE EightDoubles square_root(EightDoubles a) {
  return {square_root(a.low), square_root(a.high)};
}
FAIRWAY_INLINE unsigned bits_of(FourLongs m) {
#ifdef __AVX__
  return static_cast<unsigned>(_mm256_movemask_pd((__m256d)m));
#else
  unsigned bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (m[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}
FAIRWAY_INLINE unsigned bits_of(EightLongs m) {
  return bits_of(m.low) | bits_of(m.high) << 4U;
}
#endif

FAIRWAY_INLINE EightDoubles smaller(EightDoubles a, EightDoubles b) {
  return select(a < b, a, b);
}

/// 1 / √a. In single precision where the processor helps: its estimate and one step of Newton's,
/// to 2^-22.
FAIRWAY_INLINE EightFloats inverse_root(EightFloats a) {
#ifdef __AVX__
  const EightFloats y = (EightFloats)_mm256_rsqrt_ps((__m256)a);
  return y * (1.5F - 0.5F * a * y * y);
#else
  return 1 / square_root(a);
#endif
}
FAIRWAY_INLINE EightDoubles inverse_root(EightDoubles a) {
  return 1 / square_root(a);
}

/// To single precision.
FAIRWAY_INLINE EightFloats rounded(EightDoubles a) {
#ifdef __AVX512F__
  return __builtin_convertvector(a, EightFloats);
#else
  return __builtin_shufflevector(__builtin_convertvector(a.low, FourFloats),
                                 __builtin_convertvector(a.high, FourFloats), 0, 1, 2, 3, 4, 5, 6,
                                 7);
#endif
}

template <class V, class Scalar>
FAIRWAY_INLINE V from_array(const Scalar* values) {
  V out;
  std::memcpy(&out, values, sizeof out);
  return out;
}
template <class Real>
FAIRWAY_INLINE Lanes<Real> load(const Real* from) {
  return from_array<Lanes<Real>>(from);
}
template <class Real>
FAIRWAY_INLINE void store(Real* out, Lanes<Real> v) {
  std::memcpy(out, &v, sizeof v);
}
template <class Real>
FAIRWAY_INLINE Lanes<Real> all(Real value) {
  return Lanes<Real>{} + value;
}

/// The mask of the lanes whose bits are set.
template <class Real>
FAIRWAY_INLINE Mask<Real> mask_of(unsigned bits) {
  std::conditional_t<std::is_same_v<Real, float>, std::int32_t, std::int64_t> lanes[8];
  for (unsigned i = 0; i < 8; ++i) lanes[i] = (bits >> i & 1U) != 0 ? -1 : 0;
  return from_array<Mask<Real>>(lanes);
}

FAIRWAY_INLINE EightFloats magnitude(EightFloats a) {
  return bits_as_numbers(bits_as_mask(a) & 0x7FFFFFFF);
}
FAIRWAY_INLINE FourDoubles magnitude(FourDoubles a) {
  return bits_as_numbers(bits_as_mask(a) & 0x7FFFFFFFFFFFFFFF);
}
FAIRWAY_INLINE EightDoubles magnitude(EightDoubles a) {
  return bits_as_numbers(bits_as_mask(a) & 0x7FFFFFFFFFFFFFFF);
}

/// The largest magnitude of many numbers. Bit patterns of magnitudes are ordered like their values,
/// and those of infinity and NaN are the largest, so that neither is lost.
template <class Real>
class LargestMagnitude {
 public:
  FAIRWAY_INLINE void see(Lanes<Real> a) {
    const Mask<Real> bits = bits_as_mask(magnitude(a));
    most_ = select(bits > most_, bits, most_);
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

/// Vectors side by side.
template <class V>
struct VectorsOf {
  V x, y, z;

  FAIRWAY_INLINE VectorsOf operator+(const VectorsOf& b) const {
    return {x + b.x, y + b.y, z + b.z};
  }
  FAIRWAY_INLINE VectorsOf operator-(const VectorsOf& b) const {
    return {x - b.x, y - b.y, z - b.z};
  }
  FAIRWAY_INLINE VectorsOf operator*(V s) const { return {x * s, y * s, z * s}; }
};
template <class Real>
using Vectors = VectorsOf<Lanes<Real>>;

template <class V>
FAIRWAY_INLINE V dot(const VectorsOf<V>& a, const VectorsOf<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
FAIRWAY_INLINE VectorsOf<V> cross(const VectorsOf<V>& a, const VectorsOf<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
FAIRWAY_INLINE VectorsOf<V> select(typename Traits<V>::Mask mask, const VectorsOf<V>& a,
                                   const VectorsOf<V>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// arctan(t) / t as a polynomial in z = t² for |t| ≤ tan(π/8): Chebyshev approximations with errors
/// of 6e-10 and 5e-18.
FAIRWAY_INLINE EightFloats arctangent_ratio(EightFloats z) {
  constexpr float kTerms[] = {0.99999999939F,  -0.33333307493F, 0.19998210797F,
                              -0.14239982907F, 0.10572814385F,  -0.06033241468F};
  EightFloats sum = all(kTerms[5]);
  for (int i = 4; i >= 0; --i) sum = sum * z + kTerms[i];
  return sum;
}
template <class V>
FAIRWAY_INLINE V arctangent_ratio(V z) {
  constexpr double kTerms[] = {1.0,
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
  V sum = V{} + kTerms[11];
  for (int i = 10; i >= 0; --i) sum = sum * z + kTerms[i];
  return sum;
}

/// The angle in [0, π] whose sine and cosine stand in the ratio of `sine` ≥ 0 and `cosine`; 0 where
/// both vanish.
template <class V>
FAIRWAY_INLINE V angle_of(V sine, V cosine) {
  using Real = typename Traits<V>::Scalar;
  using Mask = typename Traits<V>::Mask;
  constexpr Real kPi = static_cast<Real>(3.14159265358979323846);
  constexpr Real kTangentOfEighth = static_cast<Real>(0.41421356237309504880);
  const V x = magnitude(cosine);
  const Mask steep = sine > x;
  const V small = select(steep, x, sine);
  const V large = select(steep, sine, x);
  const Mask beyond = small > large * kTangentOfEighth;
  const V over = select(beyond, small - large, small);
  const V under = select(beyond, small + large, large);
  const V zero = {};
  const V t = select(under > zero, over / under, zero);
  V angle = t * arctangent_ratio(t * t);
  angle = select(beyond, angle + kPi / 4, angle);
  angle = select(steep, kPi / 2 - angle, angle);
  return select(cosine < zero, kPi - angle, angle);
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
