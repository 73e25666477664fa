#pragma once

#include <cstdint>
#include <optional>

#include "proto/messages/format.h"

namespace fairway {

/// Memory in bytes that a job needs at least for a mesh file of so many bytes: from below, so that
/// a job is refused for it only where it could not be done. A glTF may be mostly images, which are
/// passed on; the other formats are all mesh.
std::uint64_t least_memory(Format format, std::uint64_t bytes);

/// Address space in bytes that a job with a mesh file of so many bytes needs at most, from far
/// above; none for formats that compress, where a few bytes may honestly become any mesh.
std::optional<std::uint64_t> most_memory(Format format, std::uint64_t bytes);

}  // namespace fairway
