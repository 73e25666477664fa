#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace fairway {

/// So many random bytes (at most 256) of the kernel's generator, in base64 (RFC 4648, padded).
std::string random_base64(std::size_t bytes);

/// HMAC-SHA-256 (RFC 2104) of a text in base64, under a key that is given in base64. Nothing where
/// the key is none.
std::optional<std::string> hmac_sha256(std::string_view base64_key, std::string_view text);

}  // namespace fairway
