// The readers of a client's HTTP.

#include <algorithm>
#include <array>
#include <string>

#include <sys/eventfd.h>
#include <sys/socket.h>

#include "server/fairwayd/http/connection.h"
#include "server/fairwayd/http/http_head.h"
#include "server/fairwayd/http/multipart_reader.h"
#include "tests/fuzz/targets.h"

namespace fairway::test {
namespace {

constexpr std::size_t kMostBody = 3000;

/// What a server saw of one client.
struct Seen {
  std::string log;     ///< heads and bodies in order, then how it ended
  std::string defect;  ///< "", or the promise that was broken
};

/// One request after its head. Returns whether another may follow.
bool read_request(Connection& connection, const RequestHead& head, std::size_t piece, Seen& seen) {
  std::string space(piece, '\0');
  std::string body;
  while (true) {
    const auto got = connection.read_body(space);
    if (!got) {
      seen.log += "error " + got.error().message;
      return false;
    }
    if (*got > piece) seen.defect = "more bytes than there was space for";
    if (*got == 0) break;
    body.append(space, 0, *got);
  }
  if (body.size() > kMostBody) seen.defect = "a body beyond its limit";
  if (!connection.body_is_over()) seen.defect = "a body that ended is not over";
  if (head.framing.length && body.size() != *head.framing.length) {
    seen.defect = "a body of another length than declared";
  }
  seen.log += body + "|";
  return true;
}

/// Serves `bytes` as one client that sends them at once and hangs up.
Seen serve(std::string_view bytes, std::size_t piece) {
  std::array<int, 2> ends{};
  Seen seen;
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) return {"", "no socket pair"};
  UniqueFd client(ends[0]);
  const UniqueFd never(::eventfd(0, EFD_CLOEXEC));
  ConnectionLimits limits;
  limits.body_bytes = kMostBody;
  Connection connection(UniqueFd(ends[1]), limits, never.get());
  const ssize_t sent =
      ::send(client.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(bytes.size())) return {"", "the input does not fit the socket"};
  ::shutdown(client.get(), SHUT_WR);
  while (true) {
    const auto head = connection.read_head();
    if (!head) {
      seen.log += "error " + head.error().message;
      return seen;
    }
    if (!*head) return seen;
    seen.log += (*head)->text;
    if (!read_request(connection, **head, piece, seen)) return seen;
  }
}

/// A form that arrives in pieces of this size: its parts in order, or "error".
Seen read_form(std::string_view bytes, std::size_t piece) {
  Seen seen;
  std::size_t parts = 0;
  MultipartReader reader("B", [&bytes, piece](std::span<char> space) -> Result<std::size_t> {
    const std::size_t count = bytes.copy(space.data(), std::min(piece, space.size()));
    bytes.remove_prefix(count);
    return count;
  });
  const auto done = reader.read(
      [&](const PartHead& head) {
        ++parts;
        if (head.name.size() + head.file_name.size() + head.content_type.size() >
            kMaxPartHeadBytes) {
          seen.defect = "the head of a part is longer than it may be";
        }
        seen.log += "part " + head.name + "|" + head.file_name + "|" + head.content_type + "|";
        return Result<void>();
      },
      [&](std::span<const std::byte> content) {
        if (parts == 0 || content.empty()) seen.defect = "content of no part";
        seen.log += as_text(content);
        return Result<void>();
      });
  if (!done) seen.log = "error";
  if (!done && done.error().code != ErrorCode::bad_request) seen.defect = "no bad request";
  if (done && !bytes.empty()) seen.defect = "a form that ends before its body";
  return seen;
}

bool is_refusal(ErrorCode code) {
  return code == ErrorCode::bad_request || code == ErrorCode::uri_too_long ||
         code == ErrorCode::headers_too_large;
}

}  // namespace

std::string fuzz_http_head(ByteSpan bytes) {
  const auto head = parse_request_head(as_text(bytes));
  if (!head) {
    return is_refusal(head.error().code) ? "" : "a broken head is no bad request";
  }
  if (head->framing.chunked && head->framing.length) return "a body with two ends";
  const auto again = parse_request_head(head->text);
  if (!again) return "the head for the library does not read: " + again.error().message;
  if (again->text != head->text) return "the head for the library hides lines of its own";
  if (again->framing.has_body() || again->framing.length || again->expects_continue ||
      again->has_content_encoding) {
    return "framing reaches the library";
  }
  return {};
}

std::string fuzz_connection(ByteSpan bytes) {
  constexpr std::size_t kFitsSocket = 32 * 1024;
  const std::string_view text = as_text(bytes).substr(0, kFitsSocket);
  const Seen whole = serve(text, 4096);
  if (!whole.defect.empty()) return whole.defect;
  const Seen pieces = serve(text, 3);
  if (!pieces.defect.empty()) return pieces.defect;
  // Where a body is refused, pieces of it may have been handed on before.
  const bool refused = whole.log.find("error ") != std::string::npos;
  return refused || whole.log == pieces.log ? "" : "the size of the reads changes what is read";
}

std::string fuzz_multipart(ByteSpan bytes) {
  const Seen whole = read_form(as_text(bytes), 65536);
  if (!whole.defect.empty()) return whole.defect;
  for (const std::size_t piece : {1U, 7U}) {
    const Seen pieces = read_form(as_text(bytes), piece);
    if (!pieces.defect.empty()) return pieces.defect;
    if (pieces.log != whole.log) return "the size of the pieces changes what is read";
  }
  return {};
}

}  // namespace fairway::test
