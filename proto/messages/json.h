#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.h"

namespace fairway {

/// A JSON document that keeps the order of its keys.
using Json = nlohmann::ordered_json;

/// Limits of parse_json.
struct JsonLimits {
  std::size_t depth = 64;  ///< nesting of arrays and objects
};

/// Parses strict JSON: one value, UTF-8 (a byte order mark is skipped), no NaN, no comments, no
/// duplicate keys, bounded depth. Errors: malformed_input, with the byte offset in the message.
Result<Json> parse_json(std::string_view text, const JsonLimits& limits = {});

/// Compact text. Invalid UTF-8 (which parse_json never lets in) is replaced.
std::string dump_json(const Json& json);

/// `pointer` + "/" + `key`, escaped (RFC 6901).
std::string child_pointer(std::string_view pointer, std::string_view key);

}  // namespace fairway
