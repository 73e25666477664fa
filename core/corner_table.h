#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway {

// Corner c = 3 f + slot of face f names a vertex of the face and the side that starts there.
constexpr Index next_corner(Index c) {
  return c % 3 == 2 ? c - 2 : c + 1;
}
constexpr Index previous_corner(Index c) {
  return c % 3 == 0 ? c + 2 : c - 1;
}

/// For each side the side it is joined to, kNoIndex at a boundary. Two sides are joined where they
/// are the only ones between their two ends and run in opposite directions.
struct CornerTable {
  std::vector<Index> opposite;       ///< by the corner a side starts at
  bool may_have_duplicates = false;  ///< two faces may have the same three corners

  /// The corner at the same vertex in the next face counter-clockwise, clockwise; kNoIndex at the
  /// end of an open fan.
  Index counter_clockwise(Index c) const { return opposite[previous_corner(c)]; }
  Index clockwise(Index c) const {
    const Index other = opposite[c];
    return other == kNoIndex ? kNoIndex : next_corner(other);
  }
};

/// `faces`: three distinct vertices each, below `vertex_count`. Linear time, whatever the valences
/// (sides are sorted only at vertices of high valence).
CornerTable corner_table(std::span<const Triangle> faces, std::size_t vertex_count);

}  // namespace fairway
