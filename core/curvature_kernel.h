#pragma once

#include <cstddef>

#include "core/flow_kernels.h"

namespace fairway {

/// The rings of a TriangleMesh and positions in mean edges.
struct RingView {
  const Index* offsets;  ///< of the ring of vertex v: offsets[v] … offsets[v + 1]
  const Index* neighbours;
  const unsigned char* open;  ///< 1 where the ring runs from boundary edge to boundary edge
  const Quad<double>* positions;
};

/// Where curvature goes: one number per vertex, three for directions. As floats numbers are
/// rounded, and those beyond the range become its ends.
template <class Real>
struct CurvatureArrays {
  Real *k1, *k2, *mean, *gaussian, *predominant;
  Real *dir1, *dir2;
};

/// What one call works with, per ring entry of a vertex: numbers of eight lanes.
inline constexpr std::size_t kCurvatureScratch = 8;

/// Curvature of the vertices [first, last), eight at a time, times `per_length` (squared where
/// gaussian); see CurvatureFields. `scratch`: kLanes · kCurvatureScratch numbers, aligned to 64
/// bytes, for each of `most` + 1 ring entries, `most` the largest valence.
template <class Real>
using CurvatureKernel = void (*)(const RingView& rings, double per_length, Index first, Index last,
                                 double* scratch, const CurvatureArrays<Real>& out);

/// The kernel of an instruction set; the portable one where the build has none for it.
template <class Real>
CurvatureKernel<Real> curvature_kernel(Isa isa);

}  // namespace fairway
