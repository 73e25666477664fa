#pragma once

#include <span>

#include "core/result.h"
#include "proto/formats/document.h"
#include "proto/formats/gltf_output.h"
#include "proto/formats/gltf_surfaces.h"

namespace fairway {

/// Puts the results of all surfaces into a copy of their document: new accessors are appended, the
/// triangle primitives point to them, everything else stays. Draco primitives become plain, or all
/// become what `encoding` asks for. Returns notes about that. Errors: diverged (a position no float
/// holds), internal (results that do not fit their surfaces), those of encode_draco(). `surfaces`
/// are those that `layout` describes, `results` what became of them.
Result<std::vector<std::string>> patch_surfaces(const GltfTables& tables, const GltfLayout& layout,
                                                std::span<const Surface> surfaces,
                                                std::span<const SurfaceResult> results,
                                                const Encoding& encoding, GltfOutput& output);

}  // namespace fairway
