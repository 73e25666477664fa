#pragma once

#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// How meshes are written with Draco. Bits are those of one component; 0 keeps floats as they are.
struct DracoOptions {
  int position_bits = 14;   ///< 0 … 30, of the largest extent of the mesh
  int normal_bits = 10;     ///< 0, 2 … 30, of an octahedral coordinate
  int texcoord_bits = 12;   ///< 0 … 30, of the larger extent of the coordinates
  int curvature_bits = 16;  ///< 0 … 30, of the range of an attribute's values
  int level = 7;            ///< 0 (fast) … 10 (small)
  bool keep_order = true;   ///< false: vertices and triangles may be reordered, which is smaller
};

/// What becomes of the triangle primitives of a glTF: `keep` is each as it came.
enum class Compression { none, draco, meshopt, keep };

/// How a result is written.
struct Encoding {
  Compression compression = Compression::none;
  DracoOptions draco;
};

/// Takes "compression" and "draco" from a parameter document.
Encoding read_encoding(ObjectReader& reader);

/// Puts the same keys, every one stated, into a parameter document.
void add_encoding(const Encoding& encoding, Json& document);

}  // namespace fairway
