#pragma once

#include <memory>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"

namespace fairway {

/// decode() for bare .drc triangle meshes.
Result<std::unique_ptr<Document>> decode_drc(ByteSpan bytes);

}  // namespace fairway
