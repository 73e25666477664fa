// The kernels, compiled once per instruction set by the flow_kernels_*.cpp files, each of which
// names its set in FAIRWAY_KERNELS_NAMESPACE. Everything is in that namespace or anonymous: no
// function compiled for a newer processor can take the place of one that an older processor runs.
// Sources: Hildebrandt & Polthier 2004, eqs. (2), (6), (8), (11).

#include <cstring>
#include <type_traits>

#include <immintrin.h>

#include "core/flow_kernels.h"

#define FAIRWAY_INLINE inline __attribute__((always_inline))

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
  Lanes<double> out;
  for (int i = 0; i < 8; ++i) out[i] = __builtin_sqrt(a[i]);
  return out;
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
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (m[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
}

template <class V>
FAIRWAY_INLINE V magnitude(V a) {
  return a < 0 ? -a : a;
}

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

template <class T>
using Stored = Quad<typename StoredCoordinate<T>::Type>;

/// Eight stored positions, coordinate by coordinate.
template <class Real>
struct Gathered;
template <>
struct Gathered<float> {
  Mask<float> x, y, z;
};
template <>
struct Gathered<double> {
  Lanes<double> x, y, z;
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
          (Mask<float>)_mm256_unpacklo_epi64(z01, z23)};
#else
  Gathered<float> out;
  for (int i = 0; i < 8; ++i) {
    const Stored<float>& p = positions[slots[i]];
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.z[i] = p.z;
  }
  return out;
#endif
}
FAIRWAY_INLINE Gathered<double> gather(const Stored<double>* positions, const Index* slots) {
  Gathered<double> out;
  for (int i = 0; i < 8; ++i) {
    const Stored<double>& p = positions[slots[i]];
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.z[i] = p.z;
  }
  return out;
}

/// q − p in L: exact differences of fixed-point coordinates.
FAIRWAY_INLINE Vectors<float> between(const Gathered<float>& p, const Gathered<float>& q,
                                      float quantum) {
  return {__builtin_convertvector(q.x - p.x, Lanes<float>) * quantum,
          __builtin_convertvector(q.y - p.y, Lanes<float>) * quantum,
          __builtin_convertvector(q.z - p.z, Lanes<float>) * quantum};
}
FAIRWAY_INLINE Vectors<double> between(const Gathered<double>& p, const Gathered<double>& q,
                                       double /*quantum*/) {
  return {q.x - p.x, q.y - p.y, q.z - p.z};
}

/// The positions of a slice's own eight slots.
template <class Real>
FAIRWAY_INLINE Gathered<Real> own(const Stored<Real>* positions, Index slice) {
  const Index first = kLanes * slice;
  const Index slots[8] = {first,     first + 1, first + 2, first + 3,
                          first + 4, first + 5, first + 6, first + 7};
  return gather(positions, slots);
}

/// The triangles (p, q_k, q_{k+1}) of eight rings: unit normals, 0 where absent, and what else the
/// sums need.
template <class Real>
struct Fan {
  using V = Lanes<Real>;
  // (2 · 1e-12 L²)²: faces with less area count as absent.
  static constexpr Real kLeastTwiceAreaSquared = static_cast<Real>(4e-24);

  Vectors<Real> normal;
  Vectors<Real> twice_area_vector;
  V twice_area;
  V inverse;  ///< 1 / twice_area, 0 where absent

  FAIRWAY_INLINE Fan(const Vectors<Real>& a, const Vectors<Real>& b) {
    const Vectors<Real> n = cross(a, b);
    const V squared = dot(n, n);
    const V length = square_root(squared);
    const V zero = {};
    const Mask<Real> present = squared > kLeastTwiceAreaSquared;
    inverse = present ? 1 / length : zero;
    twice_area = present ? length : zero;
    normal = n * inverse;
    twice_area_vector = normal * twice_area;
  }
};

/// Sums over the rings of eight vertices.
template <class Real>
struct Sums {
  using V = Lanes<Real>;
  Vectors<Real> curvature = {};    ///< Σ w H_e N_e
  Vectors<Real> area_vector = {};  ///< Σ twice area · N
  V twice_area = {};
  V cotangents = {};  ///< Σ (|cot| + |cot|) = 2 K_pp

  FAIRWAY_INLINE void add_face(const Fan<Real>& fan, const Vectors<Real>& a, V aa,
                               const Vectors<Real>& b, V bb) {
    area_vector = area_vector + fan.twice_area_vector;
    twice_area += fan.twice_area;
    const V ab = dot(a, b);
    cotangents += (magnitude(aa - ab) + magnitude(bb - ab)) * fan.inverse;
  }

  /// The edge along `e` with `left` counter-clockwise of it. Returns which lanes are strong.
  FAIRWAY_INLINE unsigned add_edge(const Fan<Real>& left, const Fan<Real>& right,
                                   const Vectors<Real>& e, const StepNumbers<Real>& numbers) {
    const V zero = {};
    const Vectors<Real> term = cross(e, left.normal - right.normal);
    const V squared = dot(term, term);
    const Mask<Real> whole = (left.inverse > zero) & (right.inverse > zero);
    V weight = whole ? zero + 1 : zero;
    const Mask<Real> over = whole & (squared > numbers.lambda * numbers.lambda);
    const unsigned strong = bits_of(over);
    if (strong != 0) {
      const V excess = square_root(squared) / numbers.lambda - 1;
      const V less = 1 / (numbers.transition * excess * excess + 1);
      weight = over ? less : weight;
    }
    curvature = curvature + term * weight;
    return strong;
  }
};

template <class Real, bool kOpen>
FAIRWAY_INLINE Sums<Real> sum_ring(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
                                   Index slice, std::uint8_t* strong) {
  using V = Lanes<Real>;
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Gathered<Real> p = own<Real>(mesh.positions, slice);
  const auto edge_to = [&](Index k) {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}), mesh.quantum);
  };
  Sums<Real> sums;
  const Vectors<Real> first = edge_to(0);
  const V first_squared = dot(first, first);
  Vectors<Real> a = first;
  V aa = first_squared;
  Vectors<Real> b = edge_to(1);
  V bb = dot(b, b);
  const Fan<Real> first_face(a, b);
  sums.add_face(first_face, a, aa, b, bb);
  Fan<Real> before = first_face;
  for (Index k = 1; k + 1 < s.valence; ++k) {
    a = b;
    aa = bb;
    b = edge_to(k + 1);
    bb = dot(b, b);
    const Fan<Real> face(a, b);
    sums.add_face(face, a, aa, b, bb);
    strong[k] = static_cast<std::uint8_t>(sums.add_edge(face, before, a, numbers));
    before = face;
  }
  if constexpr (kOpen) {
    strong[0] = strong[s.valence - 1] = 0;
  } else {
    const Fan<Real> last_face(b, first);
    sums.add_face(last_face, b, bb, first, first_squared);
    strong[s.valence - 1] = static_cast<std::uint8_t>(sums.add_edge(last_face, before, b, numbers));
    strong[0] = static_cast<std::uint8_t>(sums.add_edge(first_face, last_face, first, numbers));
  }
  return sums;
}

/// The lowest bit of f says "feature vertex".
FAIRWAY_INLINE Lanes<float> clear_lowest_bit(Lanes<float> f) {
  return (Lanes<float>)((Mask<float>)f & ~1);
}
FAIRWAY_INLINE Lanes<double> clear_lowest_bit(Lanes<double> f) {
  return (Lanes<double>)((Mask<double>)f & ~std::int64_t{1});
}

template <class Real>
FAIRWAY_INLINE void store_quads(Quad<Real>* out, const Vectors<Real>& v, Lanes<Real> w) {
  for (int i = 0; i < 8; ++i) out[i] = {v.x[i], v.y[i], v.z[i], w[i]};
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

template <class Real>
FAIRWAY_INLINE void store(Real* out, Lanes<Real> v) {
  std::memcpy(out, &v, sizeof v);
}

template <class Real>
void curvature(const KernelMesh<Real>& mesh, const StepNumbers<Real>& numbers,
               const KernelFields<Real>& fields, Index first, Index last) {
  using V = Lanes<Real>;
  const V zero = {};
  for (Index slice = first; slice < last; ++slice) {
    std::uint8_t* strong = fields.strong + mesh.slices[slice].columns;
    const Sums<Real> sums = mesh.slices[slice].open
                                ? sum_ring<Real, true>(mesh, numbers, slice, strong)
                                : sum_ring<Real, false>(mesh, numbers, slice, strong);
    const std::size_t slot = kLanes * std::size_t{slice};
    const Mask<Real> any = sums.twice_area > zero;
    // 1 / M_pp = 6 / Σ twice area; ½ / K_pp = 1 / Σ cotangents.
    V step = 6 * numbers.time_step / sums.twice_area;
    if (numbers.local_step) {
      const V stable = 1 / sums.cotangents;
      step = step < stable ? step : stable;
    }
    step = any ? step : zero;
    const Vectors<Real> h = sums.curvature * (zero + static_cast<Real>(0.5));
    store_quads<Real>(fields.curvature + slot, h, step);
    if (!numbers.prescribed) continue;
    const Vectors<Real> volume = sums.area_vector * (zero + static_cast<Real>(1.0 / 6.0));
    const V squared = dot(volume, volume);
    const V along = dot(h, volume);
    V f;
    if (numbers.measure == KernelMeasure::project) {
      f = along / squared;
    } else if (numbers.measure == KernelMeasure::mass) {
      f = 6 * square_root(dot(h, h)) / sums.twice_area;
      f = along < zero ? -f : f;
    } else {
      f = square_root(dot(h, h) / squared);
      f = along < zero ? -f : f;
    }
    f = squared > zero ? f : zero;
    store_quads<Real>(fields.direction + slot, volume, zero);
    store<Real>(fields.value + slot, clear_lowest_bit(f));
  }
}

template <class Real>
void bends(const KernelMesh<Real>& mesh, Index first, Index last, Real* out) {
  using V = Lanes<Real>;
  const V zero = {};
  const auto bend = [&](const Fan<Real>& left, const Fan<Real>& right) {
    const Vectors<Real> difference = left.normal - right.normal;
    const Mask<Real> whole = (left.inverse > zero) & (right.inverse > zero);
    return whole ? dot(difference, difference) : zero - 1;
  };
  for (Index slice = first; slice < last; ++slice) {
    const Slice& s = mesh.slices[slice];
    const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
    const Gathered<Real> p = own<Real>(mesh.positions, slice);
    const auto edge_to = [&](Index k) {
      return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}), mesh.quantum);
    };
    const Vectors<Real> first_edge = edge_to(0);
    Vectors<Real> a = edge_to(1);
    const Fan<Real> first_face(first_edge, a);
    Fan<Real> before = first_face;
    for (Index k = 1; k + 1 < s.valence; ++k) {
      const Vectors<Real> b = edge_to(k + 1);
      const Fan<Real> face(a, b);
      store<Real>(out + kLanes * std::size_t{k}, bend(face, before));
      before = face;
      a = b;
    }
    const Fan<Real> last_face(a, first_edge);
    store<Real>(out + kLanes * std::size_t{s.valence - 1},
                s.open ? zero - 1 : bend(last_face, before));
    store<Real>(out, s.open ? zero - 1 : bend(first_face, last_face));
    out += kLanes * std::size_t{s.valence};
  }
}

FAIRWAY_INLINE Lanes<float> gather_values(const float* values, const Index* slots) {
#ifdef __AVX2__
  const __m256i at = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(slots));
  return (Lanes<float>)_mm256_i32gather_ps(values, at, 4);
#else
  Lanes<float> out;
  for (int i = 0; i < 8; ++i) out[i] = values[slots[i]];
  return out;
#endif
}
FAIRWAY_INLINE Lanes<double> gather_values(const double* values, const Index* slots) {
  Lanes<double> out;
  for (int i = 0; i < 8; ++i) out[i] = values[slots[i]];
  return out;
}

/// (1 − m) f + m · average of f over the neighbours that count.
template <class Real>
FAIRWAY_INLINE Lanes<Real> averaged(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers,
                                    const Real* value, Index slice) {
  using V = Lanes<Real>;
  const V zero = {};
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  V f;
  std::memcpy(&f, value + kLanes * std::size_t{slice}, sizeof f);
  const Mask<Real> kind = (Mask<Real>)f & 1;
  V sum = zero;
  V count = zero;
  for (Index k = 0; k < s.valence; ++k) {
    V q = gather_values(value, column + kLanes * std::size_t{k});
    const Mask<Real> same = ((Mask<Real>)q & 1) == kind;
    Mask<Real> counts = same;
    if (!numbers.own_kind) {
      counts = counts | (kind == 0);
      q = same ? q : q * numbers.mean_edge_squared;
    }
    sum += counts ? q : zero;
    count += counts ? zero + 1 : zero;
  }
  const V mean = (1 - numbers.fraction) * f + numbers.fraction * sum / count;
  return count > zero ? mean : f;
}

template <class Real>
void average(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers, const Real* value,
             Index first, Index last, Real* out) {
  for (Index slice = first; slice < last; ++slice) {
    const std::size_t slot = kLanes * std::size_t{slice};
    Lanes<Real> f;
    std::memcpy(&f, value + slot, sizeof f);
    const Mask<Real> kind = (Mask<Real>)f & 1;
    const Lanes<Real> mean = clear_lowest_bit(averaged(mesh, numbers, value, slice));
    store<Real>(out + slot, (Lanes<Real>)((Mask<Real>)mean | kind));
  }
}

/// A fixed-point coordinate less a length, rounded. What does not fit wraps around: move() answers
/// the magnitude, so that the caller sees it.
FAIRWAY_INLINE std::int32_t moved(std::int32_t from, float by, float per_quantum) {
#ifdef __SSE2__
  const auto difference = static_cast<std::uint32_t>(_mm_cvtss_si32(_mm_set_ss(by * per_quantum)));
#else
  const float units = by * per_quantum;
  const bool fits = units > -2e9F && units < 2e9F;
  const auto difference = static_cast<std::uint32_t>(fits ? __builtin_lrintf(units) : 0);
#endif
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(from) - difference);
}

template <class Real>
FAIRWAY_INLINE Real keep_largest(Real largest, Real value) {
  // Written so that NaN stays.
  return value <= largest ? largest : value;
}

template <class Real>
Real move(const KernelMesh<Real>& mesh, const MoveNumbers<Real>& numbers,
          const KernelFields<Real>& fields, Index first, Index last, Stored<Real>* out) {
  const Real per_quantum = 1 / mesh.quantum;
  Real largest = 0;
  for (Index slice = first; slice < last; ++slice) {
    const std::size_t slot = kLanes * std::size_t{slice};
    Lanes<Real> f = {};
    if (numbers.prescribed) {
      if (numbers.fraction > 0) {
        f = averaged(mesh, numbers, fields.value, slice);
      } else {
        std::memcpy(&f, fields.value + slot, sizeof f);
      }
    }
    for (int i = 0; i < 8; ++i) {
      const Stored<Real>& p = mesh.positions[slot + static_cast<std::size_t>(i)];
      Quad<Real> v = fields.curvature[slot + static_cast<std::size_t>(i)];
      if (numbers.prescribed) {
        const Quad<Real>& d = fields.direction[slot + static_cast<std::size_t>(i)];
        v.x -= f[i] * d.x;
        v.y -= f[i] * d.y;
        v.z -= f[i] * d.z;
      }
      Stored<Real>& to = out[slot + static_cast<std::size_t>(i)];
      const Real x = static_cast<Real>(p.x) - v.w * v.x * per_quantum;
      const Real y = static_cast<Real>(p.y) - v.w * v.y * per_quantum;
      const Real z = static_cast<Real>(p.z) - v.w * v.z * per_quantum;
      largest = keep_largest(largest, magnitude(x));
      largest = keep_largest(largest, magnitude(y));
      largest = keep_largest(largest, magnitude(z));
      if constexpr (std::is_same_v<Real, float>) {
        to = {moved(p.x, v.w * v.x, per_quantum), moved(p.y, v.w * v.y, per_quantum),
              moved(p.z, v.w * v.z, per_quantum), 0};
      } else {
        to = {x, y, z, 0};
      }
    }
  }
  return largest;
}

template <class Real>
double displacement(const KernelMesh<Real>& mesh, const Stored<Real>* start,
                    const Quad<Real>* normals, Index first, Index last) {
  double sum = 0.0;
  for (Index slice = first; slice < last; ++slice) {
    Real part = 0;
    for (std::size_t slot = kLanes * std::size_t{slice}; slot < kLanes * (std::size_t{slice} + 1);
         ++slot) {
      const Stored<Real>& p = mesh.positions[slot];
      const Stored<Real>& s = start[slot];
      const Quad<Real>& n = normals[slot];
      const Real d = (static_cast<Real>(p.x - s.x) * n.x + static_cast<Real>(p.y - s.y) * n.y +
                      static_cast<Real>(p.z - s.z) * n.z) *
                     mesh.quantum;
      part += d * d;
    }
    sum += static_cast<double>(part);
  }
  return sum;
}

template <class Real>
constexpr FlowKernels<Real> kKernels = {&bends<Real>, &curvature<Real>, &average<Real>, &move<Real>,
                                        &displacement<Real>};

}  // namespace

const FlowKernels<float>& single_kernels() {
  return kKernels<float>;
}
const FlowKernels<double>& double_kernels() {
  return kKernels<double>;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
