#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace fairway::quality {

/// A clean mesh to add noise to.
struct Model {
  std::string name;
  IndexedMesh mesh;
  bool sharp = false;  ///< a part with edges: no face may be flipped at up to 0.2
};

/// Names of the models of the shared collection, and of the generated ones.
std::vector<std::string> shared_models();
std::vector<std::string> generated_models();

/// A model of either kind; nothing, said plainly, where it is absent.
std::optional<Model> model(const std::string& name);

}  // namespace fairway::quality
