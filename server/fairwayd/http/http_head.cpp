#include "server/fairwayd/http/http_head.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

Error bad(std::string message) {
  return {ErrorCode::bad_request, std::move(message)};
}

Error too_long(bool request_line) {
  if (request_line) {
    return {ErrorCode::uri_too_long,
            fmt::format("The request line is longer than {} bytes: send parameters as a part of a "
                        "form.",
                        kMaxHeadLine)};
  }
  return {ErrorCode::headers_too_large,
          fmt::format("A header is longer than {} bytes.", kMaxHeadLine)};
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return (u < 0x20 && c != '\t') || u == 0x7f;
  });
}

Result<void> check_request_line(std::string_view line) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return bad("The request line is broken.");
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (!is_token(line.substr(0, first))) return bad("The method is not a word.");
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    return bad("Only HTTP/1.1 and HTTP/1.0 are spoken here.");
  }
  if (target.empty() || target.front() != '/' || target.find(' ') != std::string_view::npos ||
      has_control(target)) {
    return bad("The request target is not a path.");
  }
  return {};
}

Result<void> take_length(std::string_view value, RequestHead& head) {
  if (head.framing.length) return bad("There is more than one Content-Length.");
  std::uint64_t length = 0;
  const char* end = value.data() + value.size();
  const auto [stop, status] = std::from_chars(value.data(), end, length);
  // More than 64 bits is a number all the same, and too large wherever it is compared.
  if (status == std::errc::result_out_of_range && stop == end) length = UINT64_MAX;
  if (value.empty() || stop != end || status == std::errc::invalid_argument ||
      value.front() == '-') {
    return bad("Content-Length is not a number.");
  }
  head.framing.length = length;
  return {};
}

Result<void> take_transfer(std::string_view value, RequestHead& head) {
  if (head.framing.chunked || !same_word(value, "chunked")) {
    return bad("The only transfer coding taken here is one \"chunked\".");
  }
  head.framing.chunked = true;
  return {};
}

/// Headers that the HTTP library must not see.
bool is_dealt_with(std::string_view name) {
  constexpr std::array<std::string_view, 8> kNames = {
      "Content-Length", "Transfer-Encoding", "Content-Encoding", "Expect", "Accept-Encoding",
      "Range",          "If-Range",          "Connection"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [name](std::string_view known) { return same_word(name, known); });
}

Result<void> take_header(std::string_view line, RequestHead& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)) || has_control(line)) {
    return bad("A header line is broken.");
  }
  const std::string_view name = line.substr(0, colon);
  const std::string_view value = trim_blanks(line.substr(colon + 1));
  if (same_word(name, "Content-Length")) return take_length(value, head);
  if (same_word(name, "Transfer-Encoding")) return take_transfer(value, head);
  if (same_word(name, "Content-Encoding")) {
    head.has_content_encoding = head.has_content_encoding || !same_word(value, "identity");
  } else if (same_word(name, "Expect")) {
    if (!same_word(value, "100-continue")) return bad("The only expectation met is 100-continue.");
    head.expects_continue = true;
  } else if (same_word(name, "Connection")) {
    if (same_word(value, "close")) head.keep_alive = false;
  }
  head.headers.emplace_back(lower_case(name), value);
  if (!is_dealt_with(name)) head.text.append(line).append("\r\n");
  return {};
}

}  // namespace

Result<RequestHead> parse_request_head(std::string_view text) {
  RequestHead head;
  std::size_t lines = 0;
  while (true) {
    const std::size_t end = text.find("\r\n");
    if (end == std::string_view::npos) return bad("The request head is cut short.");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 2);
    if (line.empty()) break;
    if (line.size() > kMaxHeadLine) return too_long(lines == 0);
    if (++lines > kMaxHeaders + 1) {
      return Error{ErrorCode::headers_too_large,
                   fmt::format("A request has at most {} headers.", kMaxHeaders)};
    }
    auto taken = lines == 1 ? check_request_line(line) : take_header(line, head);
    if (!taken) return taken.error();
    if (lines == 1) {
      head.keep_alive = line.ends_with("1.1");
      head.text.append(line).append("\r\n");
    }
  }
  if (lines == 0) return bad("The request line is missing.");
  if (head.framing.chunked && head.framing.length) {
    return bad("Content-Length and Transfer-Encoding exclude each other.");
  }
  head.text.append("\r\n");
  return head;
}

}  // namespace fairway
