#pragma once

#include <memory>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"
#include "proto/formats/side_files.h"

namespace fairway {

/// decode() for GLB and .gltf.
Result<std::unique_ptr<Document>> decode_gltf(ByteSpan bytes, Format format,
                                              const SideFiles& side_files);

}  // namespace fairway
