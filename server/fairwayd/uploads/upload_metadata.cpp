#include "server/fairwayd/uploads/upload_metadata.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "proto/messages/base64.h"
#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

Error bad_request(std::string what) {
  return {ErrorCode::bad_request, std::move(what)};
}

/// "key value", "key".
std::pair<std::string_view, std::string_view> split_pair(std::string_view text) {
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos) return {text, {}};
  return {text.substr(0, space), trim_blanks(text.substr(space))};
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<UploadMetadata> parse_upload_metadata(std::string_view text) {
  UploadMetadata metadata;
  std::set<std::string_view> keys;
  for (const std::string_view pair : split_field(text, ',')) {
    const auto [key, encoded] = split_pair(pair);
    const auto value = decode_base64(encoded);
    if (!value || !keys.insert(key).second) {
      return bad_request(
          "Upload-Metadata takes keys, each once, with a blank and their value in base64 behind "
          "them, and commas between them.");
    }
    if (key == "filename") metadata.file_name = text_of(*value);
    if (key == "filetype") metadata.file_type = text_of(*value);
  }
  return metadata;
}

Result<ExpectedChecksum> parse_upload_checksum(std::string_view text) {
  constexpr std::size_t kSha1Bytes = 20;
  constexpr std::size_t kSha256Bytes = 32;
  const auto [name, encoded] = split_pair(text);
  auto digest = decode_base64(encoded);
  const bool is_sha1 = name == "sha1";
  if ((!is_sha1 && name != "sha256") || !digest ||
      digest->size() != (is_sha1 ? kSha1Bytes : kSha256Bytes)) {
    return bad_request("Upload-Checksum is sha256 or sha1, a blank, and the digest in base64.");
  }
  return ExpectedChecksum{is_sha1 ? ChecksumAlgorithm::sha1 : ChecksumAlgorithm::sha256,
                          *std::move(digest)};
}

}  // namespace fairway
