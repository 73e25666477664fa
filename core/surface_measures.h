#pragma once

#include <cstddef>

#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Least, mean and largest of some numbers; all 0 where there are none.
struct Spread {
  double least = 0.0;
  double mean = 0.0;
  double largest = 0.0;
};

/// Sizes of a surface.
struct SurfaceMeasures {
  Vec3 box_min = Vec3::Zero();  ///< in the coordinates of the source, length
  Vec3 box_max = Vec3::Zero();
  std::size_t edges = 0;
  Spread edge_length;    ///< length
  Spread triangle_area;  ///< length²
  double area = 0.0;     ///< length²
  /// Triangles with a height below a hundredth of their longest side.
  std::size_t needles = 0;

  double box_diagonal() const { return (box_max - box_min).norm(); }
  /// The largest magnitude of a coordinate, length.
  double reach() const { return box_min.cwiseAbs().cwiseMax(box_max.cwiseAbs()).maxCoeff(); }
};

/// Measures every edge and face once.
SurfaceMeasures surface_measures(const TriangleMesh& mesh);

}  // namespace fairway
