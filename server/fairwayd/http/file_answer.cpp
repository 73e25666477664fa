// Files over HTTP: conditions, ranges and digests. Nothing here knows what a job is.
#include "server/fairwayd/http/file_answer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/fairwayd/http/http_conditions.h"
#include "server/fairwayd/http/http_range.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

constexpr int kPartialContent = 206;
constexpr int kNotModified = 304;

std::string content_range(const ByteRange& range, std::uint64_t bytes) {
  return fmt::format("bytes {}-{}/{}", range.first, range.last, bytes);
}

/// Several ranges as multipart/byteranges (RFC 9110, 14.6).
std::vector<FilePiece> multipart_pieces(const std::vector<ByteRange>& ranges,
                                        const FileFacts& facts, const std::string& boundary) {
  std::vector<FilePiece> pieces;
  std::string before;
  for (const ByteRange& range : ranges) {
    before += fmt::format("--{}\r\nContent-Type: {}\r\nContent-Range: {}\r\n\r\n", boundary,
                          facts.media_type, content_range(range, facts.bytes));
    pieces.push_back({std::exchange(before, "\r\n"), range.first, range.size()});
  }
  pieces.push_back({fmt::format("\r\n--{}--\r\n", boundary), 0, 0});
  return pieces;
}

/// What every answer about this version says, with content or without.
NameValues version_headers(const EntityTag& tag) {
  return {{"ETag", to_string(tag)}, {"Cache-Control", "private, no-transform"}, {"Vary", "Accept"}};
}

HttpResponse not_modified(const EntityTag& tag) {
  HttpResponse response;
  response.status = kNotModified;
  response.headers = version_headers(tag);
  return response;
}

HttpResponse refused_range(const Error& error, std::uint64_t bytes) {
  HttpResponse response = problem_response(error);
  response.headers.emplace_back("Content-Range", fmt::format("bytes */{}", bytes));
  return response;
}

/// A Range counts for GET only, once, and where If-Range does not say otherwise.
Result<std::vector<ByteRange>> ranges_of(const HttpRequest& request, const EntityTag& tag,
                                         std::uint64_t bytes) {
  const auto count = std::count_if(request.headers.begin(), request.headers.end(),
                                   [](const auto& header) { return header.first == "range"; });
  if (request.method != "GET" || count != 1 || !may_apply_range(request, tag)) {
    return std::vector<ByteRange>();
  }
  return parse_range(request.header("range").value_or(""), bytes);
}

/// Says which bytes of the file the body is made of.
void fill_body(HttpResponse& response, UniqueFd file, const std::vector<ByteRange>& ranges,
               const FileFacts& facts) {
  response.content_type = facts.media_type;
  std::vector<FilePiece> pieces;
  if (ranges.empty()) {
    pieces.push_back({"", 0, facts.bytes});
  } else if (ranges.size() == 1) {
    pieces.push_back({"", ranges.front().first, ranges.front().size()});
    response.headers.emplace_back("Content-Range", content_range(ranges.front(), facts.bytes));
  } else {
    const std::string boundary = random_id();
    pieces = multipart_pieces(ranges, facts, boundary);
    response.content_type = "multipart/byteranges; boundary=" + boundary;
  }
  if (!ranges.empty()) response.status = kPartialContent;
  response.file = FileBody{std::move(file), std::move(pieces)};
}

unsigned hex_value(char digit) {
  return static_cast<unsigned>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
}

}  // namespace

std::string safe_file_name(std::string_view name) {
  std::string safe(name);
  for (char& c : safe) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '.' || c == '-' || c == '_';
    if (!plain) c = '_';
  }
  if (safe.starts_with('.')) safe.front() = '_';
  return safe;
}

std::string repr_digest(std::string_view sha256_hex) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  // Three hexadecimal digits are twelve bits, two digits of base 64.
  for (std::size_t i = 0; i < sha256_hex.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t j = i; j < i + 3; ++j) {
      bits = bits << 4U | (j < sha256_hex.size() ? hex_value(sha256_hex[j]) : 0U);
    }
    text += kDigits[bits >> 6U];
    if (i + 1 < sha256_hex.size()) text += kDigits[bits & 63U];
  }
  while (text.size() % 4 != 0) text += '=';
  return fmt::format("sha-256=:{}:", text);
}

HttpResponse file_answer(const HttpRequest& request, UniqueFd file, const FileFacts& facts) {
  const EntityTag tag{facts.sha256};
  const Condition condition = evaluate_conditions(request, tag);
  if (condition == Condition::not_modified) return not_modified(tag);
  if (condition == Condition::failed) {
    return problem_response(
        {ErrorCode::precondition_failed, "The result has another ETag than If-Match names."});
  }
  const auto ranges = ranges_of(request, tag, facts.bytes);
  if (!ranges) return refused_range(ranges.error(), facts.bytes);
  HttpResponse response;
  response.headers = version_headers(tag);
  response.headers.emplace_back("Accept-Ranges", "bytes");
  response.headers.emplace_back("Repr-Digest", repr_digest(facts.sha256));
  response.headers.emplace_back(
      "Content-Disposition",
      fmt::format("attachment; filename=\"{}\"", safe_file_name(facts.file_name)));
  fill_body(response, std::move(file), *ranges, facts);
  return response;
}

}  // namespace fairway
