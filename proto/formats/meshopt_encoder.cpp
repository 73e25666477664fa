// Writing the streams of EXT_meshopt_compression. Source: its specification, appendix A.

#include "proto/formats/meshopt_encoder.h"

#include <cstring>

#include <meshoptimizer.h>

#include "core/index.h"

namespace fairway {
namespace {

// The versions that the extension asks for; the library would write older indices.
constexpr int kAttributeVersion = 0;
constexpr int kIndexVersion = 1;
constexpr std::uint64_t kMaxStride = 256;

std::vector<std::byte> encode_attributes(ByteSpan bytes, std::size_t count, std::size_t stride) {
  meshopt_encodeVertexVersion(kAttributeVersion);
  std::vector<std::byte> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        bytes.data(), count, stride));
  return out;
}

std::vector<unsigned int> widen(ByteSpan bytes, std::size_t count, std::size_t stride) {
  std::vector<unsigned int> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* data = bytes.data() + i * stride;
    out.push_back(stride == 2 ? load<std::uint16_t>(data) : load<std::uint32_t>(data));
  }
  return out;
}

std::vector<std::byte> encode_indices(ByteSpan bytes, std::size_t count, std::size_t stride) {
  const std::vector<unsigned int> indices = widen(bytes, count, stride);
  meshopt_encodeIndexVersion(kIndexVersion);
  std::vector<std::byte> out(meshopt_encodeIndexSequenceBound(count, kNoIndex));
  out.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                         indices.data(), count));
  return out;
}

}  // namespace

std::vector<std::byte> encode_meshopt(ByteSpan bytes, const MeshoptLayout& layout) {
  const auto count = static_cast<std::size_t>(layout.count);
  const auto stride = static_cast<std::size_t>(layout.stride);
  if (count == 0 || layout.filter != MeshoptFilter::none) return {};
  switch (layout.mode) {
    case MeshoptMode::attributes:
      if (stride == 0 || stride > kMaxStride || stride % 4 != 0) return {};
      return encode_attributes(bytes, count, stride);
    case MeshoptMode::indices:
      if (stride != 2 && stride != 4) return {};
      return encode_indices(bytes, count, stride);
    case MeshoptMode::triangles:
      break;
  }
  return {};
}

}  // namespace fairway
