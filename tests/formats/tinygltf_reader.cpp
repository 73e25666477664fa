#include "tests/formats/tinygltf_reader.h"

#define tinygltf fairway_test_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>
#undef tinygltf

namespace fairway::test {
namespace {

namespace gltf = ::fairway_test_tinygltf;

std::size_t components_of(const gltf::Accessor& accessor) {
  return accessor.type == TINYGLTF_TYPE_SCALAR ? 1 : static_cast<std::size_t>(accessor.type);
}

template <class T>
std::vector<T> read_accessor(const gltf::Model& model, const gltf::Accessor& accessor) {
  const auto& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  const auto stride = static_cast<std::size_t>(accessor.ByteStride(view));
  const std::size_t components = components_of(accessor);
  std::vector<T> out(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i) {
    const std::size_t at = view.byteOffset + accessor.byteOffset + i * stride;
    std::memcpy(out.data() + i * components, data.data() + at, components * sizeof(T));
  }
  return out;
}

}  // namespace

OtherReading read_with_tinygltf(const Bytes& bytes, Format format) {
  gltf::TinyGLTF reader;
  gltf::Model model;
  OtherReading out;
  std::string warning;
  const auto size = static_cast<unsigned>(bytes.size());
  out.loaded =
      format == Format::glb
          ? reader.LoadBinaryFromMemory(&model, &out.problem, &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()), size)
          : reader.LoadASCIIFromString(&model, &out.problem, &warning,
                                       reinterpret_cast<const char*>(bytes.data()), size, "");
  if (!out.loaded || model.meshes.empty()) return out;
  out.generator = model.asset.generator;
  out.nodes = model.nodes.size();
  const gltf::Primitive& primitive = model.meshes.front().primitives.front();
  for (const auto& [name, index] : primitive.attributes) {
    const gltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) {
      out.attributes[name] = read_accessor<float>(model, accessor);
    }
  }
  if (primitive.indices < 0) return out;
  const gltf::Accessor& indices = model.accessors[static_cast<std::size_t>(primitive.indices)];
  if (indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    for (const auto i : read_accessor<std::uint16_t>(model, indices)) out.indices.push_back(i);
  } else {
    out.indices = read_accessor<std::uint32_t>(model, indices);
  }
  return out;
}

}  // namespace fairway::test
