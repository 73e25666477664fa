#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace fairway {

/// The SHA-256 in a Repr-Digest field (RFC 9530), as 64 lower-case hexadecimal digits; nothing
/// where it has none that can be read.
std::optional<std::string> sha256_of_repr_digest(std::string_view field);

}  // namespace fairway
