#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace fairway {

/// Limits of a request's head.
inline constexpr std::size_t kMaxHeadBytes = 64 * 1024;
inline constexpr std::size_t kMaxHeadLine = 8000;
inline constexpr std::size_t kMaxHeaders = 100;

/// How a body ends.
struct Framing {
  bool chunked = false;
  std::optional<std::uint64_t> length;  ///< declared Content-Length

  bool has_body() const { return chunked || length.value_or(0) > 0; }
};

/// A request head that keeps to the letter of RFC 9112 where it matters for where a request ends.
struct RequestHead {
  Framing framing;
  bool keep_alive = true;
  bool has_content_encoding = false;  ///< other than identity
  bool expects_continue = false;
  /// All headers but those that frame the message; names in lower case.
  std::vector<std::pair<std::string, std::string>> headers;
  /// The same head for the HTTP library, without the lines that are dealt with before it: framing,
  /// Expect, and what would make it transform bodies (Accept-Encoding, Range).
  std::string text;
};

/// Reads a head, from the request line to the empty line. Errors: bad_request,
/// uri_too_long, headers_too_large. A request without framing has no body; whether it should have
/// one is for the route to say.
Result<RequestHead> parse_request_head(std::string_view head);

}  // namespace fairway
