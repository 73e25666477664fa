#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// Classes of equal positions, numbered by first appearance. −0 equals 0.
struct Weld {
  std::vector<Index> place;  ///< class of each position
  std::size_t count = 0;     ///< number of classes
};
Weld weld_equal_positions(std::span<const Vec3> positions);

}  // namespace fairway
