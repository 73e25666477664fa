// The kernels of the linear systems, compiled once per instruction set. See lanes_impl.h.
// Source: van der Vorst 1992 (BiCGSTAB).

#pragma once

#include "core/system_rows_impl.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// A quad in one register.
FAIRWAY_INLINE FourDoubles quad_at(const Quad<double>* from, std::size_t slot) {
  return from_array<FourDoubles>(&from[slot].x);
}
FAIRWAY_INLINE void put_quad(Quad<double>* to, std::size_t slot, FourDoubles value) {
  std::memcpy(to + slot, &value, sizeof value);
}
FAIRWAY_INLINE Quad<double> as_quad(FourDoubles a) {
  return {a[0], a[1], a[2], 0.0};
}

/// Has the slots of a slice some way ahead fetched: rings reach all over a window of PackedMesh,
/// which no hardware foresees.
FAIRWAY_INLINE void fetch_ahead(const ScaledMatrix& matrix, const Quad<double>* vector,
                                Index slice) {
  constexpr Index kAhead = 2560 / kLanes;
  if (slice + kAhead >= matrix.slice_count) return;
  const Quad<double>* from = vector + kLanes * std::size_t{slice + kAhead};
  for (Index i = 0; i < kLanes; i += 2) __builtin_prefetch(from + i, 0, 3);
}

/// Calls use(slot, row of D⁻¹ A times the vector) for the slots of some slices; `at(slot)` is the
/// vector.
template <Index kValence, class At, class Use>
FAIRWAY_INLINE void multiply_slice(const ScaledMatrix& matrix, Index slice, const At& at,
                                   const Use& use) {
  const Slice& s = matrix.slices[slice];
  const Index* ring = matrix.ring + kLanes * std::size_t{s.columns};
  const double* coefficients = matrix.coefficients + kLanes * std::size_t{s.columns};
  const Index valence = kValence == 0 ? s.valence : kValence;
  for (Index lane = 0; lane < kLanes; ++lane) {
    const std::size_t slot = kLanes * std::size_t{slice} + lane;
    const FourDoubles own = at(slot);
    // Two sums: one would wait for itself.
    FourDoubles even = own;
    FourDoubles odd = {};
#pragma GCC unroll 8
    for (Index k = 0; k < valence; ++k) {
      (k % 2 == 0 ? even : odd) += coefficients[kLanes * k + lane] * at(ring[kLanes * k + lane]);
    }
    use(slot, own, even + odd);
  }
}
template <class At, class Fetch, class Use>
FAIRWAY_INLINE void multiply(const ScaledMatrix& matrix, Index first, Index last, const At& at,
                             const Fetch& fetch, const Use& use) {
  for (Index slice = first; slice < last; ++slice) {
    fetch(slice);
    switch (matrix.slices[slice].valence) {
      case 5:
        multiply_slice<5>(matrix, slice, at, use);
        break;
      case 6:
        multiply_slice<6>(matrix, slice, at, use);
        break;
      case 7:
        multiply_slice<7>(matrix, slice, at, use);
        break;
      default:
        multiply_slice<0>(matrix, slice, at, use);
    }
  }
}

SolverSums start(const ScaledMatrix& matrix, const Quad<double>* b, const SolverVectors& to,
                 Index first, Index last) {
  FourDoubles bb = {};
  FourDoubles rr = {};
  const std::size_t end = kLanes * std::size_t{last};
  for (std::size_t i = kLanes * std::size_t{first}; i < end; ++i) {
    const FourDoubles value = {b[i].x, b[i].y, b[i].z, 0.0};
    const FourDoubles r = value / matrix.diagonal[i];
    bb += value * value;
    rr += r * r;
    put_quad(to.x, i, FourDoubles{});
    for (Quad<double>* vector : {to.r, to.shadow, to.p}) put_quad(vector, i, r);
  }
  return {as_quad(bb), as_quad(rr), {}, {}};
}

SolverSums search(const ScaledMatrix& of, const SolverVectors& in, Index first, Index last) {
  // By value: what is stored cannot change them.
  const ScaledMatrix matrix = of;
  const SolverVectors vectors = in;
  FourDoubles along = {};
  const Quad<double>* p = vectors.p;
  multiply(
      matrix, first, last, [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(p, i); },
      [&](Index slice) FAIRWAY_LAMBDA { fetch_ahead(matrix, p, slice); },
      [&](std::size_t i, FourDoubles /*own*/, FourDoubles v) FAIRWAY_LAMBDA {
        put_quad(vectors.v, i, v);
        along += quad_at(vectors.shadow, i) * v;
      });
  return {as_quad(along), {}, {}, {}};
}

SolverSums stabilise(const ScaledMatrix& of, const SolverVectors& in, const SolverScalars& scalars,
                     Index first, Index last) {
  const FourDoubles alpha = quad_at(&scalars.alpha, 0);
  const ScaledMatrix matrix = of;
  const SolverVectors vectors = in;
  FourDoubles ts = {};
  FourDoubles tt = {};
  FourDoubles shadow_s = {};
  FourDoubles shadow_t = {};
  const Quad<double>* r = vectors.r;
  const Quad<double>* v = vectors.v;
  // s is not stored: reading r and v again costs less.
  multiply(
      matrix, first, last,
      [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(r, i) - alpha * quad_at(v, i); },
      [&](Index slice) FAIRWAY_LAMBDA {
        fetch_ahead(matrix, r, slice);
        fetch_ahead(matrix, v, slice);
      },
      [&](std::size_t i, FourDoubles s, FourDoubles t) FAIRWAY_LAMBDA {
        put_quad(vectors.t, i, t);
        const FourDoubles shadow = quad_at(vectors.shadow, i);
        ts += t * s;
        tt += t * t;
        shadow_s += shadow * s;
        shadow_t += shadow * t;
      });
  return {as_quad(ts), as_quad(tt), as_quad(shadow_s), as_quad(shadow_t)};
}

SolverSums advance(const ScaledMatrix& matrix, const SolverVectors& vectors,
                   const SolverScalars& scalars, Index first, Index last) {
  const FourDoubles alpha = quad_at(&scalars.alpha, 0);
  const FourDoubles beta = quad_at(&scalars.beta, 0);
  const FourDoubles omega = quad_at(&scalars.omega, 0);
  FourDoubles error = {};
  const std::size_t end = kLanes * std::size_t{last};
  for (std::size_t i = kLanes * std::size_t{first}; i < end; ++i) {
    const FourDoubles p = quad_at(vectors.p, i);
    const FourDoubles v = quad_at(vectors.v, i);
    const FourDoubles s = quad_at(vectors.r, i) - alpha * v;
    const FourDoubles r = s - omega * quad_at(vectors.t, i);
    put_quad(vectors.x, i, quad_at(vectors.x, i) + alpha * p + omega * s);
    put_quad(vectors.r, i, r);
    put_quad(vectors.p, i, r + beta * (p - omega * v));
    const FourDoubles unscaled = r * matrix.diagonal[i];
    error += unscaled * unscaled;
  }
  return {as_quad(error), {}, {}, {}};
}

SolverSums residual(const ScaledMatrix& matrix, const Quad<double>* b, const Quad<double>* x,
                    Index first, Index last) {
  FourDoubles error = {};
  multiply(
      matrix, first, last, [&](std::size_t i) FAIRWAY_LAMBDA { return quad_at(x, i); },
      [&](Index slice) FAIRWAY_LAMBDA { fetch_ahead(matrix, x, slice); },
      [&](std::size_t i, FourDoubles /*own*/, FourDoubles ax) FAIRWAY_LAMBDA {
        const FourDoubles e = quad_at(b, i) - matrix.diagonal[i] * ax;
        error += e * e;
      });
  return {as_quad(error), {}, {}, {}};
}

constexpr SystemKernels kSystemKernels = {&assemble,  &start,   &search,
                                          &stabilise, &advance, &residual};

}  // namespace

const SystemKernels& linear_kernels() {
  return kSystemKernels;
}

}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
