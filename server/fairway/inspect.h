#pragma once

#include <cstddef>
#include <span>

#include "core/result.h"
#include "proto/formats/side_files.h"
#include "proto/messages/format.h"
#include "proto/messages/inspection.h"
#include "server/fairway/pipeline.h"

namespace fairway {

/// Looks at a file in memory and changes nothing: decode → topology → sizes → noise. A surface that
/// cannot be computed with is a finding, not an error. Errors: those of decode().
Result<Inspection> inspect(std::span<const std::byte> input, Format format,
                           const ProgressObserver& observer, const SideFiles& side_files = {});

}  // namespace fairway
