// The kernels of the linear systems, compiled once per instruction set. See lanes_impl.h.
// Source: van der Vorst 1992 (BiCGSTAB).

#pragma once

#include "core/system_rows_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// A quad in one register.
template <class Real>
using Four = std::conditional_t<std::is_same_v<Real, float>, FourFloats, FourDoubles>;

template <class Real>
FAIRWAY_INLINE Four<Real> quad_at(const Quad<Real>* from, std::size_t slot) {
  return from_array<Four<Real>>(&from[slot].x);
}
template <class Real>
FAIRWAY_INLINE void put_quad(Quad<Real>* to, std::size_t slot, Four<Real> value) {
  std::memcpy(to + slot, &value, sizeof value);
}
template <class Real>
FAIRWAY_INLINE Four<Real> in_precision(FourDoubles a) {
  return __builtin_convertvector(a, Four<Real>);
}
template <class Real>
FAIRWAY_INLINE Four<Real> in_precision(const Quad<double>& a) {
  return in_precision<Real>(quad_at(&a, 0));
}

/// A sum over many slots, in double; over the slots of a slice in Real.
template <class Real>
class Sum {
 public:
  FAIRWAY_INLINE void add(Four<Real> value) { part_ += value; }
  FAIRWAY_INLINE void end_slice() {
    total_ += __builtin_convertvector(part_, FourDoubles);
    part_ = Four<Real>{};
  }
  FAIRWAY_INLINE Quad<double> value() const { return {total_[0], total_[1], total_[2], 0.0}; }

 private:
  FourDoubles total_ = {};
  Four<Real> part_ = {};
};

/// Has the slots of a slice some way ahead fetched: rings reach all over a window of PackedMesh,
/// which no hardware foresees.
template <class Real, class Vector>
FAIRWAY_INLINE void fetch_ahead(const ScaledMatrix<Real>& matrix, const Quad<Vector>* vector,
                                Index slice) {
  constexpr Index kAhead = 2560 / kLanes;
  constexpr Index kPerLine = 64 / sizeof(Quad<Vector>);
  if (slice + kAhead >= matrix.slice_count) return;
  const Quad<Vector>* from = vector + kLanes * std::size_t{slice + kAhead};
  for (Index i = 0; i < kLanes; i += kPerLine) __builtin_prefetch(from + i, 0, 3);
}

/// Calls use(slot, own, row of D⁻¹ A times the vector) for the slots of a slice; `at(slot)` is the
/// vector, own = at(own slot).
template <class Real, Index kValence, class At, class Use>
FAIRWAY_INLINE void multiply_slice(const ScaledMatrix<Real>& matrix, Index slice, const At& at,
                                   const Use& use) {
  const Slice& s = matrix.slices[slice];
  const Index* ring = matrix.ring + kLanes * std::size_t{s.columns};
  const Real* coefficients = matrix.coefficients + kLanes * std::size_t{s.columns};
  const Index valence = kValence == 0 ? s.valence : kValence;
  for (Index lane = 0; lane < kLanes; ++lane) {
    const std::size_t slot = kLanes * std::size_t{slice} + lane;
    const Four<Real> own = at(slot);
    // Two sums: one would wait for itself.
    Four<Real> even = own;
    Four<Real> odd = {};
#pragma GCC unroll 8
    for (Index k = 0; k < valence; ++k) {
      (k % 2 == 0 ? even : odd) += coefficients[kLanes * k + lane] * at(ring[kLanes * k + lane]);
    }
    use(slot, own, even + odd);
  }
}
/// The same for the slices [first, last); calls before(slice) and after() around each.
template <class Real, class At, class Before, class Use, class After>
FAIRWAY_INLINE void multiply(const ScaledMatrix<Real>& matrix, Index first, Index last,
                             const At& at, const Before& before, const Use& use,
                             const After& after) {
  for (Index slice = first; slice < last; ++slice) {
    before(slice);
    switch (matrix.slices[slice].valence) {
      case 5:
        multiply_slice<Real, 5>(matrix, slice, at, use);
        break;
      case 6:
        multiply_slice<Real, 6>(matrix, slice, at, use);
        break;
      case 7:
        multiply_slice<Real, 7>(matrix, slice, at, use);
        break;
      default:
        multiply_slice<Real, 0>(matrix, slice, at, use);
    }
    after();
  }
}

SolverSums size(const double* diagonal, const Quad<double>* b, Index first, Index last) {
  FourDoubles bb = {};
  FourDoubles rr = {};
  const std::size_t end = kLanes * std::size_t{last};
  for (std::size_t i = kLanes * std::size_t{first}; i < end; ++i) {
    const FourDoubles value = quad_at(b, i);
    const FourDoubles r = value / diagonal[i];
    bb += value * value;
    rr += r * r;
  }
  return {{bb[0], bb[1], bb[2], 0.0}, {rr[0], rr[1], rr[2], 0.0}, {}, {}};
}

template <class Real>
SolverSums restart(const ScaledMatrix<double>& of, const Quad<double>* b, const Quad<double>* x,
                   const Quad<double>& factor, const SolverVectors<Real>& to, Index first,
                   Index last) {
  // By value: what is stored cannot change them.
  const ScaledMatrix<double> matrix = of;
  const SolverVectors<Real> vectors = to;
  const FourDoubles factors = quad_at(&factor, 0);
  Sum<double> ee;
  Sum<Real> rr;
  multiply(
      matrix, first, last, [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(x, i); },
      [&](Index slice) FAIRWAY_LAMBDA { fetch_ahead(matrix, x, slice); },
      [&](std::size_t i, FourDoubles /*own*/, FourDoubles ax) FAIRWAY_LAMBDA {
        const double diagonal = matrix.diagonal[i];
        const FourDoubles e = quad_at(b, i) - diagonal * ax;
        const Four<Real> r = in_precision<Real>(e * factors / diagonal);
        ee.add(e * e);
        rr.add(r * r);
        put_quad(vectors.x, i, Four<Real>{});
        put_quad(vectors.r, i, r);
        put_quad(vectors.shadow, i, r);
        put_quad(vectors.p, i, r);
      },
      [&]() FAIRWAY_LAMBDA {
        ee.end_slice();
        rr.end_slice();
      });
  return {ee.value(), rr.value(), {}, {}};
}

template <class Real>
SolverSums search(const ScaledMatrix<Real>& of, const SolverVectors<Real>& in, Index first,
                  Index last) {
  const ScaledMatrix<Real> matrix = of;
  const SolverVectors<Real> vectors = in;
  Sum<Real> along;
  const Quad<Real>* p = vectors.p;
  multiply(
      matrix, first, last, [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(p, i); },
      [&](Index slice) FAIRWAY_LAMBDA { fetch_ahead(matrix, p, slice); },
      [&](std::size_t i, Four<Real> /*own*/, Four<Real> v) FAIRWAY_LAMBDA {
        put_quad(vectors.v, i, v);
        along.add(quad_at(vectors.shadow, i) * v);
      },
      [&]() FAIRWAY_LAMBDA { along.end_slice(); });
  return {along.value(), {}, {}, {}};
}

template <class Real>
SolverSums stabilise(const ScaledMatrix<Real>& of, const SolverVectors<Real>& in,
                     const SolverScalars& scalars, Index first, Index last) {
  const Four<Real> alpha = in_precision<Real>(scalars.alpha);
  const ScaledMatrix<Real> matrix = of;
  const SolverVectors<Real> vectors = in;
  Sum<Real> ts, tt, shadow_s, shadow_t;
  const Quad<Real>* r = vectors.r;
  const Quad<Real>* v = vectors.v;
  // s is not stored: reading r and v again costs less.
  multiply(
      matrix, first, last,
      [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(r, i) - alpha * quad_at(v, i); },
      [&](Index slice) FAIRWAY_LAMBDA {
        fetch_ahead(matrix, r, slice);
        fetch_ahead(matrix, v, slice);
      },
      [&](std::size_t i, Four<Real> s, Four<Real> t) FAIRWAY_LAMBDA {
        put_quad(vectors.t, i, t);
        const Four<Real> shadow = quad_at(vectors.shadow, i);
        ts.add(t * s);
        tt.add(t * t);
        shadow_s.add(shadow * s);
        shadow_t.add(shadow * t);
      },
      [&]() FAIRWAY_LAMBDA {
        ts.end_slice();
        tt.end_slice();
        shadow_s.end_slice();
        shadow_t.end_slice();
      });
  return {ts.value(), tt.value(), shadow_s.value(), shadow_t.value()};
}

template <class Real>
SolverSums advance(const ScaledMatrix<Real>& matrix, const SolverVectors<Real>& in,
                   const SolverScalars& scalars, Index first, Index last) {
  const Four<Real> alpha = in_precision<Real>(scalars.alpha);
  const Four<Real> beta = in_precision<Real>(scalars.beta);
  const Four<Real> omega = in_precision<Real>(scalars.omega);
  const SolverVectors<Real> vectors = in;
  Sum<Real> error;
  for (Index slice = first; slice < last; ++slice) {
    for (Index lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = kLanes * std::size_t{slice} + lane;
      const Four<Real> p = quad_at(vectors.p, i);
      const Four<Real> v = quad_at(vectors.v, i);
      const Four<Real> s = quad_at(vectors.r, i) - alpha * v;
      const Four<Real> r = s - omega * quad_at(vectors.t, i);
      put_quad(vectors.x, i, quad_at(vectors.x, i) + alpha * p + omega * s);
      put_quad(vectors.r, i, r);
      put_quad(vectors.p, i, r + beta * (p - omega * v));
      const Four<Real> unscaled = r * matrix.diagonal[i];
      error.add(unscaled * unscaled);
    }
    error.end_slice();
  }
  return {error.value(), {}, {}, {}};
}

template <class Real>
void correct(const Quad<Real>* correction, const Quad<double>& factor, Index first, Index last,
             Quad<double>* x) {
  const FourDoubles factors = quad_at(&factor, 0);
  const std::size_t end = kLanes * std::size_t{last};
  for (std::size_t i = kLanes * std::size_t{first}; i < end; ++i) {
    put_quad(
        x, i,
        quad_at(x, i) + factors * __builtin_convertvector(quad_at(correction, i), FourDoubles));
  }
}

template <class Real>
constexpr SolverKernels<Real> kSolverKernels = {&restart<Real>, &search<Real>, &stabilise<Real>,
                                                &advance<Real>, &correct<Real>};
constexpr SystemKernels kSystemKernels = {&assemble, &size, kSolverKernels<float>,
                                          kSolverKernels<double>};

}  // namespace

const SystemKernels& linear_kernels() {
  return kSystemKernels;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
