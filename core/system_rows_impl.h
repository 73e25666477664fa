// The rows of the linear systems, eight at a time. See lanes_impl.h.
// Sources: Hildebrandt & Polthier 2004, eqs. (1)–(3), (12), (13).

#pragma once

#include "core/feature_kernels_impl.h"
#include "core/system_kernels.h"

namespace fairway::FAIRWAY_KERNELS_NAMESPACE {
namespace {

/// The triangles (p, a, b) of eight rings with their cotangents, 0 where absent.
struct SystemFace {
  using V = Lanes<double>;
  Fan<double> fan;
  V cot_p, cot_a, cot_b;

  FAIRWAY_INLINE SystemFace(const Vectors<double>& a, V aa, const Vectors<double>& b, V bb,
                            double least)
      : fan(a, b, least) {
    const V ab = dot(a, b);
    cot_p = ab * fan.inverse;
    cot_a = (aa - ab) * fan.inverse;
    cot_b = (bb - ab) * fan.inverse;
  }
};

/// The rows of eight slots as they grow.
class SystemRows {
 public:
  using V = Lanes<double>;

  FAIRWAY_INLINE SystemRows(const SystemNumbers& numbers, const std::uint8_t* strong,
                            double* entries, Index valence)
      : numbers_(numbers), strong_(strong), entries_(entries), valence_(valence) {
    const V zero = {};
    diagonal_ = zero;
    for (Index k = 0; k < valence; ++k) store(entries_ + kLanes * k, zero);
  }

  /// The face between the neighbours k and next.
  FAIRWAY_INLINE void add_mass(const SystemFace& face, Index k, Index next) {
    diagonal_ += face.fan.twice_area * (numbers_.full_mass ? 1.0 / 12.0 : 1.0 / 6.0);
    if (!numbers_.full_mass) return;
    add(k, face.fan.twice_area * (1.0 / 24.0));
    add(next, face.fan.twice_area * (1.0 / 24.0));
  }

  /// The edge `e` to neighbour k; absent beside an absent face.
  FAIRWAY_INLINE void add_edge(const SystemFace& left, const SystemFace& right,
                               const Vectors<double>& e, Index before, Index k, Index next) {
    const V zero = {};
    V weight = select(left.fan.absent | right.fan.absent, zero, all(0.5 * numbers_.time_step));
    if (strong_[k] != 0) {
      const Vectors<double> term = cross(e, left.fan.normal - right.fan.normal);
      const V excess = square_root(dot(term, term)) / numbers_.lambda - 1.0;
      const V weakened = weight / (numbers_.transition * excess * excess + 1.0);
      weight = select(mask_of<double>(strong_[k]), weakened, weight);
    }
    // At q_k: angle a of the left face, angle b of the right one.
    diagonal_ += weight * (left.cot_a + right.cot_b);
    add(k, weight * (left.cot_p + right.cot_p));
    add(next, -(weight * (left.cot_p + left.cot_a)));
    add(before, -(weight * (right.cot_p + right.cot_b)));
  }

  /// Scales to a unit diagonal. What is not a number stays so.
  FAIRWAY_INLINE void finish(double* diagonal, float* rounded_diagonal, float* rounded_entries) {
    diagonal_ = select(diagonal_ <= 0.0, all(1.0), diagonal_);
    store(diagonal, diagonal_);
    store(rounded_diagonal, rounded(diagonal_));
    const V inverse = 1.0 / diagonal_;
    for (Index k = 0; k < valence_; ++k) {
      const V entry = load(entries_ + kLanes * k) * inverse;
      store(entries_ + kLanes * k, entry);
      store(rounded_entries + kLanes * k, rounded(entry));
    }
  }

 private:
  FAIRWAY_INLINE void add(Index k, V value) {
    double* at = entries_ + kLanes * std::size_t{k};
    store(at, load(at) + value);
  }

  const SystemNumbers& numbers_;
  const std::uint8_t* strong_;
  double* entries_;
  Index valence_;
  V diagonal_;
};

FAIRWAY_INLINE void assemble_slice(const KernelMesh<double>& mesh, Index slice, double least,
                                   SystemRows& rows) {
  using V = Lanes<double>;
  const Slice& s = mesh.slices[slice];
  const Index* column = mesh.ring + kLanes * std::size_t{s.columns};
  const Gathered<double> p = own<double>(mesh.positions, slice);
  const auto edge_to = [&](Index k) FAIRWAY_LAMBDA {
    return between(p, gather(mesh.positions, column + kLanes * std::size_t{k}));
  };
  const Index last = s.valence - 1;
  const Vectors<double> first = edge_to(0);
  const V first_squared = dot(first, first);
  Vectors<double> a = edge_to(1);
  V aa = dot(a, a);
  const SystemFace first_face(first, first_squared, a, aa, least);
  rows.add_mass(first_face, 0, 1);
  SystemFace before = first_face;
  for (Index k = 1; k < last; ++k) {
    const Vectors<double> b = edge_to(k + 1);
    const V bb = dot(b, b);
    const SystemFace face(a, aa, b, bb, least);
    rows.add_mass(face, k, k + 1);
    rows.add_edge(face, before, a, k - 1, k, k + 1);
    before = face;
    a = b;
    aa = bb;
  }
  if (s.open) return;
  const SystemFace last_face(a, aa, first, first_squared, least);
  rows.add_mass(last_face, last, 0);
  rows.add_edge(last_face, before, a, last - 1, last, 0);
  rows.add_edge(first_face, last_face, first, last, 0, 1);
}

void assemble(const KernelMesh<double>& mesh, const std::uint8_t* strong,
              const SystemNumbers& numbers, Index first, Index last, const SystemEntries& to) {
  const double least = least_twice_area_squared(mesh.quantum);
  for (Index slice = first; slice < last; ++slice) {
    const Slice& s = mesh.slices[slice];
    const std::size_t entries = kLanes * std::size_t{s.columns};
    const std::size_t slots = kLanes * std::size_t{slice};
    SystemRows rows(numbers, strong + s.columns, to.coefficients + entries, s.valence);
    assemble_slice(mesh, slice, least, rows);
    rows.finish(to.diagonal + slots, to.rounded_diagonal + slots,
                to.rounded_coefficients + entries);
  }
}

}  // namespace
}  // namespace fairway::FAIRWAY_KERNELS_NAMESPACE
