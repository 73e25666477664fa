#include "tests/fuzz/seeds.h"

#include <array>
#include <utility>

namespace fairway::test {

std::vector<Seed> seeds_of(std::string_view target) {
  using Maker = std::vector<Seed> (*)();
  static constexpr std::array<std::pair<std::string_view, Maker>, 15> kMakers = {{
      {"glb", glb_seeds},
      {"meshopt_glb", meshopt_seeds},
      {"draco_glb", draco_glb_seeds},
      {"gltf", gltf_seeds},
      {"drc", drc_seeds},
      {"ply", [] { return shape_seeds(Format::ply); }},
      {"obj", [] { return shape_seeds(Format::obj); }},
      {"stl", [] { return shape_seeds(Format::stl); }},
      {"recognition", recognition_seeds},
      {"parameters", parameter_seeds},
      {"worker_order", worker_order_seeds},
      {"worker_event", worker_event_seeds},
      {"http_head", http_seeds},
      {"connection", http_seeds},
      {"multipart", multipart_seeds},
  }};
  for (const auto& [name, maker] : kMakers) {
    if (name == target) return maker();
  }
  return {};
}

}  // namespace fairway::test
