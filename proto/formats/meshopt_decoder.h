#pragma once

#include <cstdint>
#include <vector>

#include "core/result.h"
#include "proto/formats/bytes.h"

namespace fairway {

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

/// What a meshopt stream is said to hold: `count` elements, `stride` bytes apart.
struct MeshoptLayout {
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
  std::uint64_t count = 0;
  std::uint64_t stride = 0;
};

/// `count` · `stride` bytes out of an untrusted stream, filtered. Indices are not checked against
/// any vertices. What the stream cannot hold is refused before anything is allocated: a byte of
/// attributes decodes to 64 at most, a byte of triangles to one triangle, a byte of indices to one.
/// Errors: invalid_mesh, unsupported_feature (a newer version of the stream).
Result<std::vector<std::byte>> decode_meshopt(ByteSpan stream, const MeshoptLayout& layout);

}  // namespace fairway
