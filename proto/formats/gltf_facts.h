#pragma once

#include "proto/formats/document.h"
#include "proto/messages/json.h"

namespace fairway {

/// The facts of a glTF document that has been read without an error. `extras` are those of its only
/// surface.
FileFacts gltf_facts(const Json& root, const ExtraKinds& extras);

}  // namespace fairway
