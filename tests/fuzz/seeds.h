#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/formats/sample_glb.h"

namespace fairway::test {

/// A good input (or one that is refused late) to start mutating from.
struct Seed {
  std::string name;
  Bytes bytes;
};

/// The seeds of a fuzz target, made by the tests' sample makers and our own writers, the same on
/// every run. Needs a running Catch session, for the sample makers check what they do.
std::vector<Seed> seeds_of(std::string_view target);

// Where seeds_of() gets them.
std::vector<Seed> glb_seeds();
std::vector<Seed> meshopt_seeds();
std::vector<Seed> draco_glb_seeds();
std::vector<Seed> gltf_seeds();
std::vector<Seed> drc_seeds();
std::vector<Seed> shape_seeds(Format format);
std::vector<Seed> recognition_seeds();
std::vector<Seed> parameter_seeds();
std::vector<Seed> worker_order_seeds();
std::vector<Seed> worker_event_seeds();
std::vector<Seed> http_seeds();
std::vector<Seed> multipart_seeds();

}  // namespace fairway::test
