#pragma once

#include <algorithm>
#include <string_view>

namespace fairway {

/// True for an id that a client may choose: 1 … 64 letters, digits, - and _. Those of random_id()
/// are among them. Anything else never reaches a query.
constexpr bool is_job_id(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  });
}

}  // namespace fairway
