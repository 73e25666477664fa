#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace fairway {

/// Fills at most 256 bytes from the kernel's generator.
void fill_randomly(std::span<std::byte> bytes);

/// Length of a random id in characters.
inline constexpr std::size_t kRandomIdLength = 22;

/// 128 bits from the kernel's generator, as 22 URL-safe characters (base64url without padding).
std::string random_id();

/// So many random bytes (at most 256) as lower-case hexadecimal digits.
std::string random_hexadecimal(std::size_t bytes);

/// True for text of the shape that random_id() makes. Anything else never reaches a path or a
/// query.
bool is_random_id(std::string_view text);

}  // namespace fairway
