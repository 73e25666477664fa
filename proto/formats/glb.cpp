// The GLB container. Source: glTF 2.0 section 4.

#include "proto/formats/glb.h"

#include <limits>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;
constexpr std::size_t kHeaderSize = 12;
constexpr std::size_t kChunkHeaderSize = 8;

Error malformed(std::string_view what) {
  return {ErrorCode::malformed_input, fmt::format("The GLB {}; send the whole file.", what)};
}

struct Chunk {
  std::uint32_t type = 0;
  ByteSpan whole;
  ByteSpan data;
};

/// The chunk at the front of `rest`, which is not empty.
Result<Chunk> first_chunk(ByteSpan rest) {
  ByteReader reader(rest);
  const auto length = reader.read<std::uint32_t>();
  const auto type = reader.read<std::uint32_t>();
  if (!length || !type) return malformed("ends inside a chunk header");
  const auto data = reader.take(*length);
  if (!data) return malformed("has a chunk that is longer than the file");
  return Chunk{*type, rest.first(kChunkHeaderSize + data->size()), *data};
}

Result<ByteSpan> check_header(ByteSpan bytes) {
  ByteReader reader(bytes);
  const auto magic = reader.read<std::uint32_t>();
  if (!magic) return malformed("ends inside its magic");
  if (*magic != kMagic) {
    return Error{ErrorCode::unsupported_format, "These bytes are not a GLB; send GLB or glTF."};
  }
  const auto version = reader.read<std::uint32_t>();
  const auto length = reader.read<std::uint32_t>();
  if (!version || !length) return malformed("ends inside its header");
  if (*version != 2) {
    return Error{ErrorCode::unsupported_format,
                 fmt::format("This is GLB version {}; convert it to version 2.", *version)};
  }
  if (*length > bytes.size()) return malformed("is shorter than its header says");
  if (*length < bytes.size()) return malformed("has bytes after the end that its header states");
  return bytes.subspan(kHeaderSize);
}

/// Some writers pad the JSON chunk with zeros.
std::string_view without_padding(std::string_view json) {
  const std::size_t end = json.find_last_not_of('\0');
  return json.substr(0, end == std::string_view::npos ? 0 : end + 1);
}

std::vector<std::byte> chunk_header(std::uint32_t type, std::uint64_t size) {
  std::vector<std::byte> out;
  append_value(out, static_cast<std::uint32_t>(size));
  append_value(out, type);
  return out;
}

std::vector<std::byte> file_header(std::uint64_t size) {
  std::vector<std::byte> out;
  append_value(out, kMagic);
  append_value(out, std::uint32_t{2});
  append_value(out, static_cast<std::uint32_t>(size));
  return out;
}

}  // namespace

Result<GlbParts> parse_glb(ByteSpan bytes) {
  auto rest = check_header(bytes);
  if (!rest) return rest.error();
  if (rest->empty()) return malformed("has no JSON chunk");
  const auto json = first_chunk(*rest);
  if (!json) return json.error();
  if (json->type != kJsonChunk) return malformed("does not start with a JSON chunk");
  GlbParts parts;
  parts.json = without_padding(as_text(json->data));
  ByteSpan after = rest->subspan(json->whole.size());
  parts.other_chunks = after;
  while (!after.empty()) {
    const auto chunk = first_chunk(after);
    if (!chunk) return chunk.error();
    after = after.subspan(chunk->whole.size());
    // BIN is the second chunk or there is none.
    if (chunk->type == kBinChunk && chunk->whole.data() == parts.other_chunks.data()) {
      parts.bin = chunk->data;
      parts.other_chunks = after;
    }
  }
  return parts;
}

Result<ByteChain> build_glb(std::string json, const ByteChain* bin, ByteSpan other_chunks) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint64_t bin_size = bin != nullptr ? (bin->size() + 3) / 4 * 4 : 0;
  const std::uint64_t size = kHeaderSize + kChunkHeaderSize + json.size() +
                             (bin != nullptr ? kChunkHeaderSize + bin_size : 0) +
                             other_chunks.size();
  if (size > kMost) {
    return Error{ErrorCode::too_large, "The result does not fit in a GLB of 4 GiB."};
  }
  ByteChain out(file_header(size));
  out.append(chunk_header(kJsonChunk, json.size()));
  out.append(std::move(json));
  if (bin != nullptr) {
    out.append(chunk_header(kBinChunk, bin_size));
    out.append(*bin);
    out.align_to_four();
  }
  out.append_view(other_chunks);
  return out;
}

Result<std::vector<std::byte>> build_glb(const GlbParts& parts) {
  ByteChain bin;
  if (parts.bin) bin.append_view(*parts.bin);
  const auto out =
      build_glb(std::string(parts.json), parts.bin ? &bin : nullptr, parts.other_chunks);
  if (!out) return out.error();
  return out->joined();
}

}  // namespace fairway
