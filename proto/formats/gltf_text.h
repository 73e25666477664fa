#pragma once

#include <cstddef>
#include <string_view>

#include "core/result.h"

namespace fairway {

/// Bytes of a glTF's JSON that are no payload of a data URI. What a document says of millions of
/// vertices takes some kilobytes; each byte of it costs up to thirty in memory.
inline constexpr std::size_t kMaxGltfText = std::size_t{4} << 20;

/// The bytes of `json` without the payloads in it: strings that begin with "data:", but for the
/// first kUriHead bytes of each. Linear; `json` need not be JSON.
std::size_t size_without_payloads(std::string_view json);
inline constexpr std::size_t kUriHead = 64;

/// Errors: too_large where more than kMaxGltfText are left.
Result<void> check_gltf_text(std::string_view json);

}  // namespace fairway
