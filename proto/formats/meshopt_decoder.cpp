// The streams of EXT_meshopt_compression. Source: its specification, appendices A and B. The
// library is safe on untrusted streams, but asserts what it expects of counts and strides, and
// trusts the caller with the size of the destination.

#include "proto/formats/meshopt_decoder.h"

#include <meshoptimizer.h>

namespace fairway {
namespace {

constexpr std::uint64_t kMaxStride = 256;
constexpr std::uint64_t kAttributeRatio = 64;
constexpr unsigned kVersionBits = 0x0FU;
constexpr unsigned kNewestAttributes = 0;
constexpr unsigned kNewestIndices = 1;

Error broken(std::string message) {
  return {ErrorCode::invalid_mesh, std::move(message)};
}

Result<void> check_attributes(const MeshoptLayout& layout) {
  const std::uint64_t stride = layout.stride;
  if (stride == 0 || stride > kMaxStride || stride % 4 != 0) {
    return broken("Compressed attributes are 4 to 256 bytes apart, in steps of 4.");
  }
  if (layout.filter == MeshoptFilter::octahedral && stride != 4 && stride != 8) {
    return broken("The OCTAHEDRAL filter takes strides of 4 and 8 bytes.");
  }
  if (layout.filter == MeshoptFilter::quaternion && stride != 8) {
    return broken("The QUATERNION filter takes a stride of 8 bytes.");
  }
  return {};
}

Result<void> check_indices(const MeshoptLayout& layout) {
  if (layout.stride != 2 && layout.stride != 4) {
    return broken("Compressed indices are 2 or 4 bytes apart.");
  }
  if (layout.filter != MeshoptFilter::none) return broken("Compressed indices have no filter.");
  if (layout.mode == MeshoptMode::triangles && layout.count % 3 != 0) {
    return broken("Compressed triangles take a multiple of three indices.");
  }
  return {};
}

/// No stream of this size holds that much.
bool exceeds(ByteSpan stream, const MeshoptLayout& layout) {
  const std::uint64_t size = stream.size();
  switch (layout.mode) {
    case MeshoptMode::attributes:
      return layout.count > size * kAttributeRatio / layout.stride;
    case MeshoptMode::triangles:
      return layout.count / 3 > size;
    case MeshoptMode::indices:
      return layout.count > size;
  }
  return true;
}

Result<void> check(ByteSpan stream, const MeshoptLayout& layout) {
  const bool attributes = layout.mode == MeshoptMode::attributes;
  if (auto done = attributes ? check_attributes(layout) : check_indices(layout); !done) return done;
  if (layout.count == 0 || stream.empty() || exceeds(stream, layout)) {
    return broken("More compressed elements are stated than its bytes can hold, or none.");
  }
  const auto version = std::to_integer<unsigned>(stream.front()) & kVersionBits;
  if (version > (attributes ? kNewestAttributes : kNewestIndices)) {
    return Error{ErrorCode::unsupported_feature,
                 "It is compressed by a newer version of meshopt; save it with the older one."};
  }
  return {};
}

int decode_stream(ByteSpan stream, const MeshoptLayout& layout, std::vector<std::byte>& out) {
  const auto count = static_cast<std::size_t>(layout.count);
  const auto stride = static_cast<std::size_t>(layout.stride);
  const auto* data = reinterpret_cast<const unsigned char*>(stream.data());
  switch (layout.mode) {
    case MeshoptMode::attributes:
      return meshopt_decodeVertexBuffer(out.data(), count, stride, data, stream.size());
    case MeshoptMode::triangles:
      return meshopt_decodeIndexBuffer(out.data(), count, stride, data, stream.size());
    case MeshoptMode::indices:
      return meshopt_decodeIndexSequence(out.data(), count, stride, data, stream.size());
  }
  return -1;
}

void filter(const MeshoptLayout& layout, std::vector<std::byte>& out) {
  const auto count = static_cast<std::size_t>(layout.count);
  const auto stride = static_cast<std::size_t>(layout.stride);
  switch (layout.filter) {
    case MeshoptFilter::none:
      return;
    case MeshoptFilter::octahedral:
      return meshopt_decodeFilterOct(out.data(), count, stride);
    case MeshoptFilter::quaternion:
      return meshopt_decodeFilterQuat(out.data(), count, stride);
    case MeshoptFilter::exponential:
      return meshopt_decodeFilterExp(out.data(), count, stride);
  }
}

}  // namespace

Result<std::vector<std::byte>> decode_meshopt(ByteSpan stream, const MeshoptLayout& layout) {
  if (const auto done = check(stream, layout); !done) return done.error();
  std::vector<std::byte> out(static_cast<std::size_t>(layout.count * layout.stride));
  if (decode_stream(stream, layout, out) != 0) return broken("The compressed bytes are broken.");
  filter(layout, out);
  return out;
}

}  // namespace fairway
