#pragma once

#include <memory>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"

namespace fairway {

/// decode() for GLB and self-contained .gltf.
Result<std::unique_ptr<Document>> decode_gltf(ByteSpan bytes, Format format);

}  // namespace fairway
