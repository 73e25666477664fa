#pragma once

#include <string>
#include <string_view>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// The version of a representation (RFC 9110, 8.8.3). A weak one stays the same where
/// representations mean the same but differ in bytes.
struct EntityTag {
  std::string opaque;  ///< without quotes
  bool weak = false;
};

/// `"…"` or `W/"…"`.
std::string to_string(const EntityTag& tag);

/// What the preconditions of a GET or HEAD ask for, in the order of RFC 9110, 13.2.2. Other methods
/// proceed.
enum class Condition {
  proceed,       ///< answer as without preconditions
  not_modified,  ///< If-None-Match names the current version: 304
  failed,        ///< If-Match does not: 412
};
Condition evaluate_conditions(const HttpRequest& request, const EntityTag& current);

/// True where the request has If-None-Match and that names the current version.
bool knows_version(const HttpRequest& request, const EntityTag& current);

/// False where If-Range names another version than the current one, so that Range is to be ignored.
/// A date never fits: no representation here has one.
bool may_apply_range(const HttpRequest& request, const EntityTag& current);

}  // namespace fairway
