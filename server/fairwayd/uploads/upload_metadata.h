#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "server/os/checksum.h"

namespace fairway {

/// What Upload-Metadata says that matters here; other keys are kept and passed back only.
struct UploadMetadata {
  std::string file_name = {};  ///< `filename`
  std::string file_type = {};  ///< `filetype`: a media type
};

/// Reads "filename bWVzaC5nbGI=,filetype bW9kZWwvcGx5": keys, each once, with values in base64 or
/// without one (tus 1.0.0, Creation). Errors: bad_request.
Result<UploadMetadata> parse_upload_metadata(std::string_view text);

/// What bytes must have for a checksum.
struct ExpectedChecksum {
  ChecksumAlgorithm algorithm = ChecksumAlgorithm::sha256;
  std::vector<std::byte> digest;
};

/// Names of the algorithms, as in Tus-Checksum-Algorithm.
inline constexpr std::string_view kChecksumAlgorithms = "sha1,sha256";

/// Reads "sha256 <base64>" (tus 1.0.0, Checksum). Errors: bad_request.
Result<ExpectedChecksum> parse_upload_checksum(std::string_view text);

}  // namespace fairway
