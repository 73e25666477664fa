#pragma once

#include <draco/mesh/mesh.h>

#include "proto/formats/draco_decoder.h"

namespace fairway {

// Only draco_decoder.cpp and draco_encoder.cpp include this: nobody else sees the library.

/// What the library made of a file.
struct DracoMesh::Decoded {
  std::unique_ptr<draco::Mesh> mesh;
};

}  // namespace fairway
