#pragma once

#include <cstddef>
#include <vector>

#include "proto/messages/json.h"

namespace fairway {

/// How many primitives, morph targets, skins and animations of a checked glTF name each of its
/// `accessors` accessors.
std::vector<std::size_t> accessor_references(const Json& root, std::size_t accessors);

/// Takes KHR_draco_mesh_compression off the lists of extensions where no primitive has it.
void forget_unused_draco(Json& root);

}  // namespace fairway
