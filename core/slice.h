#pragma once

#include "core/index.h"

namespace fairway {

/// Vertices of one slice, computed with side by side.
inline constexpr Index kLanes = 8;

/// Eight vertices of the same valence and kind. Their slots are 8 · (number of the slice) + lane.
struct Slice {
  Index columns;  ///< neighbour k of lane i is ring[8 · (columns + k) + i]
  Index valence;
  bool open;  ///< rings run from one boundary edge to the other
};

}  // namespace fairway
