#pragma once

#include <cstddef>
#include <vector>

#include "proto/formats/document.h"
#include "proto/formats/json_fields.h"

namespace fairway {

/// What a client can name in a glTF that check_scene() passed.
SceneOutline outline_scene(const JsonPlace& root);

/// At which scale each of `meshes` meshes stands in the scene: the one uniform scale of all nodes
/// that use it, from the matrices, rotations and scales of its ancestors and its own; reflections
/// do not matter. None for a skinned mesh, whose nodes do not place it.
std::vector<WorldScale> world_scales(const JsonPlace& root, std::size_t meshes);

}  // namespace fairway
