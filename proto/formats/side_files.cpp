// Relative URIs of untrusted documents. Source: RFC 3986 sections 2.1, 4.2; glTF 2.0 section 2.8.

#include "proto/formats/side_files.h"

#include <algorithm>
#include <array>
#include <optional>

namespace fairway {
namespace {

constexpr std::size_t kMaxPath = 1024;

Error refused(std::string_view why) {
  return {ErrorCode::invalid_mesh, std::string(why)};
}

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
  return std::nullopt;
}

/// One segment with its escapes decoded; an escaped slash would make two of it.
Result<std::string> decode_segment(std::string_view segment) {
  std::string out;
  for (std::size_t i = 0; i < segment.size(); ++i) {
    char c = segment[i];
    if (c == '%') {
      const auto high = i + 2 < segment.size() ? hex_digit(segment[i + 1]) : std::nullopt;
      const auto low = high ? hex_digit(segment[i + 2]) : std::nullopt;
      if (!low) return refused("it has a broken percent escape; write a percent sign as %25.");
      c = static_cast<char>(*high * 16 + *low);
      i += 2;
    }
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F || c == '/' || c == '\\') {
      return refused("a file name has no slashes, backslashes or control characters; rename it.");
    }
    out += c;
  }
  if (out.empty() || out == "." || out == "..") {
    return refused("it must name a file in the folder of the document or below; move it there.");
  }
  return out;
}

}  // namespace

Result<std::string> path_of_uri(std::string_view uri) {
  if (uri.size() > 3 * kMaxPath) return refused("it is too long; rename the file.");
  if (uri.substr(0, uri.find('/')).find(':') != std::string_view::npos) {
    return refused("fairway opens no addresses; embed it as a data URI.");
  }
  if (uri.find_first_of("?#") != std::string_view::npos) {
    return refused("it has a query or a fragment; write these signs as %3F and %23.");
  }
  std::string path;
  for (std::size_t start = 0; start <= uri.size();) {
    const std::size_t end = std::min(uri.find('/', start), uri.size());
    auto segment = decode_segment(uri.substr(start, end - start));
    if (!segment) return segment;
    if (!path.empty()) path += '/';
    path += *segment;
    start = end + 1;
  }
  if (path.size() > kMaxPath) return refused("it is too long; rename the file.");
  return path;
}

std::string_view image_media_type(ByteSpan bytes) {
  struct Magic {
    std::size_t at;
    std::string_view bytes;
    std::string_view type;
  };
  constexpr std::array<Magic, 5> kMagics = {{{0, "\x89PNG\r\n\x1a\n", "image/png"},
                                             {0, "\xFF\xD8\xFF", "image/jpeg"},
                                             {0, "\xABKTX 20\xBB\r\n\x1a\n", "image/ktx2"},
                                             {8, "WEBP", "image/webp"},
                                             {0, "DDS ", "image/vnd-ms.dds"}}};
  const std::string_view text = as_text(bytes);
  for (const Magic& magic : kMagics) {
    if (text.size() >= magic.at && text.substr(magic.at).starts_with(magic.bytes)) {
      return magic.type;
    }
  }
  return "";
}

}  // namespace fairway
