#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "tests/formats/sample_glb.h"

namespace fairway::test {

/// What another reader finds in the first primitive of the first mesh of a glTF.
struct OtherReading {
  bool loaded = false;
  std::string problem;
  std::map<std::string, std::vector<float>> attributes;  ///< of float accessors
  std::vector<std::uint32_t> indices;
  std::string generator;
  std::size_t nodes = 0;
};

/// Reads GLB or self-contained glTF with tinygltf.
OtherReading read_with_tinygltf(const Bytes& bytes, Format format);

}  // namespace fairway::test
