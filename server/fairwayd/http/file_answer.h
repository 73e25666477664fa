#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/fairwayd/http/http_message.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A stored file as an answer shows it.
struct FileFacts {
  std::uint64_t bytes = 0;  ///< more than 0
  std::string sha256;       ///< 64 lower-case hexadecimal digits
  std::string media_type;
  std::string file_name;  ///< that a client may save it under; made safe
};

/// The answer that is a file: 200, and for GET and HEAD, whose preconditions and ranges are heeded,
/// 206, 304, 412 or 416. `file` stands at the start of `facts.bytes` bytes. The entity tag is the
/// digest.
HttpResponse file_answer(const HttpRequest& request, UniqueFd file, const FileFacts& facts);

/// `name` with all but ASCII letters, digits, '.', '-' and '_' replaced, and no '.' at its start.
std::string safe_file_name(std::string_view name);

/// The value of Repr-Digest (RFC 9530) for a digest in hexadecimal digits.
std::string repr_digest(std::string_view sha256_hex);

}  // namespace fairway
