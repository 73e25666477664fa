#include "tests/fuzz/targets.h"

#include <algorithm>
#include <array>

namespace fairway::test {

std::span<const FuzzTarget> fuzz_targets() {
  // The same reader twice where seeds of two kinds would crowd each other out of one corpus.
  static constexpr std::array<FuzzTarget, 15> kTargets = {{{"glb", fuzz_glb},
                                                           {"meshopt_glb", fuzz_glb},
                                                           {"draco_glb", fuzz_glb},
                                                           {"gltf", fuzz_gltf},
                                                           {"drc", fuzz_drc},
                                                           {"ply", fuzz_ply},
                                                           {"obj", fuzz_obj},
                                                           {"stl", fuzz_stl},
                                                           {"recognition", fuzz_recognition},
                                                           {"parameters", fuzz_parameters},
                                                           {"worker_order", fuzz_worker_order},
                                                           {"worker_event", fuzz_worker_event},
                                                           {"http_head", fuzz_http_head},
                                                           {"connection", fuzz_connection},
                                                           {"multipart", fuzz_multipart}}};
  return kTargets;
}

const FuzzTarget* find_fuzz_target(std::string_view name) {
  const auto targets = fuzz_targets();
  const auto at = std::find_if(targets.begin(), targets.end(),
                               [name](const FuzzTarget& target) { return target.name == name; });
  return at == targets.end() ? nullptr : &*at;
}

}  // namespace fairway::test
