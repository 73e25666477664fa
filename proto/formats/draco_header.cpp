// The first fields of a Draco mesh, read without the Draco library. Source: Draco bitstream
// specification, sections 3, 4, 8 and 9. The library reserves memory by these numbers, so a file of
// some bytes that claims billions of faces is refused here.

#include "proto/formats/draco_header.h"

#include <vector>

#include <fmt/format.h>

namespace fairway {
namespace {

/// A regular grid takes under a tenth of a bit per face; below this the claim is a bomb.
constexpr std::uint64_t kItemsPerByte = 256;
constexpr std::uint64_t kItemsForFree = 4096;
constexpr std::uint16_t kMetadataFlag = 0x8000;
constexpr std::uint8_t kTriangularMesh = 1;

struct DracoHeader {
  unsigned version = 0;  ///< major · 256 + minor
  std::uint8_t geometry = 0;
  std::uint8_t method = 0;
  std::uint16_t flags = 0;
};

Error cut() {
  return {ErrorCode::malformed_input, "The Draco data ends inside its header; send all of it."};
}

Result<DracoHeader> read_header(ByteReader& reader) {
  constexpr std::string_view kMagic = "DRACO";
  const auto magic = reader.take(kMagic.size());
  if (!magic) return cut();
  if (as_text(*magic) != kMagic) {
    return Error{ErrorCode::unsupported_format, "This is no Draco data; send a .drc mesh."};
  }
  const auto major = reader.read<std::uint8_t>();
  const auto minor = reader.read<std::uint8_t>();
  const auto geometry = reader.read<std::uint8_t>();
  const auto method = reader.read<std::uint8_t>();
  const auto flags = reader.read<std::uint16_t>();
  if (!flags) return cut();
  if (*major > 2 || (*major == 2 && *minor > 2 && *geometry == kTriangularMesh)) {
    return Error{ErrorCode::unsupported_format,
                 fmt::format("This is Draco {}.{}, fairway reads up to 2.2; encode it again.",
                             *major, *minor)};
  }
  return DracoHeader{*major * 256U + *minor, *geometry, *method, *flags};
}

/// One metadata node: its entries, each a name and a value. Returns how many nodes hang below.
std::optional<std::uint64_t> skip_metadata_node(ByteReader& reader) {
  const auto entries = reader.read_varint();
  if (!entries || *entries > reader.remaining()) return std::nullopt;
  for (std::uint64_t i = 0; i < *entries; ++i) {
    const auto name = reader.read<std::uint8_t>();
    if (!name || !reader.take(*name)) return std::nullopt;
    const auto size = reader.read_varint();
    if (!size || !reader.take(*size)) return std::nullopt;
  }
  const auto children = reader.read_varint();
  if (!children || *children > reader.remaining()) return std::nullopt;
  return children;
}

/// A metadata tree, depth first, without recursion: open[i] nodes are still to come on level i.
bool skip_metadata_tree(ByteReader& reader) {
  const auto children = skip_metadata_node(reader);
  if (!children) return false;
  std::vector<std::uint64_t> open = {*children};
  while (!open.empty()) {
    if (open.back() == 0) {
      open.pop_back();
      continue;
    }
    --open.back();
    const auto name = reader.read<std::uint8_t>();
    if (!name || !reader.take(*name)) return false;
    const auto below = skip_metadata_node(reader);
    if (!below) return false;
    open.push_back(*below);
  }
  return true;
}

bool skip_metadata(ByteReader& reader) {
  const auto attributes = reader.read_varint();
  if (!attributes || *attributes > reader.remaining()) return false;
  for (std::uint64_t i = 0; i < *attributes; ++i) {
    if (!reader.read_varint() || !skip_metadata_tree(reader)) return false;
  }
  return skip_metadata_tree(reader);
}

enum class CountWidth { varint, four_bytes };

std::optional<std::uint64_t> read_count(ByteReader& reader, CountWidth width) {
  if (width == CountWidth::varint) return reader.read_varint();
  const auto value = reader.read<std::uint32_t>();
  if (!value) return std::nullopt;
  return std::uint64_t{*value};
}

Result<void> check_counts(const DracoHeader& header, ByteReader& reader, std::uint64_t limit) {
  const bool edgebreaker = header.method != 0;
  const CountWidth width = header.version < (edgebreaker ? 0x200U : 0x202U) ? CountWidth::four_bytes
                                                                            : CountWidth::varint;
  // Sequential: faces, points. Edgebreaker: traversal, (new vertices,) vertices, faces.
  if (edgebreaker && !reader.read<std::uint8_t>()) return cut();
  const int counts = edgebreaker && header.version < 0x202U ? 3 : 2;
  for (int i = 0; i < counts; ++i) {
    const auto count = read_count(reader, width);
    if (!count) return cut();
    if (*count > limit) {
      return Error{ErrorCode::invalid_mesh,
                   "The Draco data claims more faces or points than its size can hold."};
    }
  }
  return {};
}

}  // namespace

Result<void> check_draco_header(ByteSpan bytes) {
  ByteReader reader(bytes);
  const auto header = read_header(reader);
  if (!header) return header.error();
  if (header->geometry == 0) {
    return Error{ErrorCode::no_triangles, "This is a Draco point cloud; send a triangle mesh."};
  }
  if (header->geometry != kTriangularMesh) {
    return Error{ErrorCode::invalid_mesh, "The Draco data has an unknown geometry type."};
  }
  const bool metadata = (header->flags & kMetadataFlag) != 0 && header->version >= 0x103U;
  if (metadata && !skip_metadata(reader)) {
    return Error{ErrorCode::malformed_input, "The metadata of the Draco data is broken or cut."};
  }
  return check_counts(*header, reader, bytes.size() * kItemsPerByte + kItemsForFree);
}

}  // namespace fairway
