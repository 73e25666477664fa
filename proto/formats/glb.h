#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "proto/formats/byte_chain.h"
#include "proto/formats/bytes.h"

namespace fairway {

/// The parts of a GLB file; they refer to the bytes it was parsed from.
struct GlbParts {
  std::string_view json;
  std::optional<ByteSpan> bin;
  ByteSpan other_chunks;  ///< whole chunks after BIN that are no business of ours
};

/// Takes a GLB apart. Errors: malformed_input (cut, lengths that contradict each other, bytes after
/// the end), unsupported_format (other magic, other version).
Result<GlbParts> parse_glb(ByteSpan bytes);

/// Chains parts to a file; the JSON chunk is padded with spaces, BIN (none if null) with zeros.
/// What `bin` and `other_chunks` refer to must outlive it. Error: too_large beyond the 4 GiB of the
/// format.
Result<ByteChain> build_glb(std::string json, const ByteChain* bin, ByteSpan other_chunks);
Result<std::vector<std::byte>> build_glb(const GlbParts& parts);

}  // namespace fairway
