#pragma once

#include "tests/formats/sample_glb.h"

namespace fairway::test {

/// What a Draco sample is made with.
struct DracoSampleOptions {
  bool edgebreaker = false;
  bool normals = false;
  bool texture_coordinates = false;
  bool colors = false;
  bool integers = false;  ///< generic, 32 bits, from one end of their range to the other
};

/// A cube compressed by Draco's own encoder: 8 points, 12 faces. Unique ids: POSITION 0, then the
/// others in the order of the options.
Bytes draco_cube(const DracoSampleOptions& options = {});

/// A point cloud of the cube's corners.
Bytes draco_point_cloud();

/// A GLB whose cube is compressed with KHR_draco_mesh_compression.
SampleGlb draco_glb(const DracoSampleOptions& options = {});

}  // namespace fairway::test
