#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fairway {

/// `text` without blanks and tabs at its ends.
std::string_view trim_blanks(std::string_view text);

/// Equal but for the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

/// ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// True for a token of RFC 9110, 5.6.2.
bool is_token(std::string_view text);

/// Splits a field value at `separator`, outside of quoted strings. Elements are trimmed; empty ones
/// are left out (RFC 9110, 5.6.1.2).
std::vector<std::string_view> split_field(std::string_view value, char separator);

/// "name=value" or "name", of a preference, a parameter.
struct NamedWord {
  std::string name;   ///< a token, in lower case
  std::string value;  ///< "" where there is none; unquoted
};

/// Nothing where the name is no token, or the value neither a token nor a whole quoted string.
std::optional<NamedWord> named_word(std::string_view text);

/// A number of digits only; what does not fit is the largest number. Nothing for anything else.
std::optional<std::uint64_t> digits_value(std::string_view text);

/// "Sun, 06 Nov 1994 08:49:37 GMT" of milliseconds since 1970 (RFC 9110, 5.6.7).
std::string http_date(std::int64_t unix_millis);

}  // namespace fairway
