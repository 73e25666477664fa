#pragma once

#include <cstdint>
#include <string>

#include "proto/messages/json.h"

namespace fairway {

/// The string at `key` of an object; "" where there is none.
inline std::string text_in(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_string() ? at->get<std::string>() : std::string();
}

/// The natural number at `key` of an object; 0 where there is none.
inline std::uint64_t number_in(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_number_unsigned() ? at->get<std::uint64_t>() : 0;
}

}  // namespace fairway
