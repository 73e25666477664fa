#include "tests/formats/meshopt_samples.h"

#include <meshoptimizer.h>

namespace fairway::test {
namespace {

unsigned char* data_of(Bytes& bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

void compress(SampleGlb& sample, std::size_t view, const char* extension, const Bytes& stream,
              Json layout) {
  layout["buffer"] = 0;
  layout["byteOffset"] = sample.bin.size();
  layout["byteLength"] = stream.size();
  sample.bin.insert(sample.bin.end(), stream.begin(), stream.end());
  sample.bin.resize((sample.bin.size() + 3) / 4 * 4);
  sample.json["bufferViews"][view]["buffer"] = 1;
  sample.json["bufferViews"][view]["extensions"][extension] = std::move(layout);
}

}  // namespace

Bytes meshopt_attributes(const Bytes& bytes, std::size_t stride) {
  const std::size_t count = bytes.size() / stride;
  Bytes out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(data_of(out), out.size(), bytes.data(), count, stride));
  return out;
}

Bytes meshopt_triangles(const std::vector<std::uint32_t>& indices) {
  Bytes out(meshopt_encodeIndexBufferBound(indices.size(), indices.size()));
  out.resize(meshopt_encodeIndexBuffer(data_of(out), out.size(), indices.data(), indices.size()));
  return out;
}

Bytes meshopt_sequence(const std::vector<std::uint32_t>& indices) {
  Bytes out(meshopt_encodeIndexSequenceBound(indices.size(), indices.size()));
  out.resize(meshopt_encodeIndexSequence(data_of(out), out.size(), indices.data(), indices.size()));
  return out;
}

SampleGlb meshopt_cube(const char* extension) {
  SampleGlb sample = cube_sample();
  const std::size_t plain = sample.bin.size();
  sample.bin.clear();
  compress(sample, 0, extension, meshopt_attributes(bytes_of(cube_corners()), 12),
           {{"byteStride", 12}, {"mode", "ATTRIBUTES"}, {"count", 8}});
  compress(sample, 1, extension, meshopt_triangles(cube_indices()),
           {{"byteStride", 4}, {"mode", "TRIANGLES"}, {"filter", "NONE"}, {"count", 36}});
  sample.json["buffers"][0]["byteLength"] = sample.bin.size();
  sample.json["buffers"].push_back(
      {{"byteLength", plain}, {"extensions", {{extension, {{"fallback", true}}}}}});
  sample.json["extensionsUsed"] = {extension};
  sample.json["extensionsRequired"] = {extension};
  return sample;
}

}  // namespace fairway::test
