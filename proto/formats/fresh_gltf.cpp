// New glTF documents, written by tinygltf. The library is compiled here under another name:
// libdraco exports a different version of its symbols, and link order must not decide which one is
// called.

#include "proto/formats/fresh_gltf.h"

#define tinygltf fairway_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>
#undef tinygltf

#include <limits>
#include <sstream>
#include <streambuf>

namespace fairway {
namespace {

namespace gltf = ::fairway_tinygltf;

/// A stream that collects its bytes where they will stay.
class ByteSink : public std::streambuf {
 public:
  std::vector<std::byte> take() { return std::move(bytes_); }

 protected:
  int_type overflow(int_type c) override {
    if (!traits_type::eq_int_type(c, traits_type::eof())) {
      bytes_.push_back(static_cast<std::byte>(c));
    }
    return traits_type::not_eof(c);
  }
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    append(bytes_, as_bytes({data, static_cast<std::size_t>(size)}));
    return size;
  }

 private:
  std::vector<std::byte> bytes_;
};

/// Appends an accessor with a view of its own to the model's only buffer.
int add_accessor(const PackedValues& values, int target, Bounds bounds, gltf::Model& model) {
  std::vector<unsigned char>& data = model.buffers.front().data;
  data.resize((data.size() + 3) / 4 * 4);
  gltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = values.bytes.size();
  view.byteStride = values.is_tight() ? 0 : values.stride;
  view.target = target;
  const auto* first = reinterpret_cast<const unsigned char*>(values.bytes.data());
  data.insert(data.end(), first, first + values.bytes.size());
  model.bufferViews.push_back(view);
  gltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  accessor.componentType = static_cast<int>(values.type);
  accessor.normalized = values.normalized;
  accessor.count = static_cast<std::size_t>(values.count);
  // The numbers of SCALAR and VEC2 … VEC4 in tinygltf.
  accessor.type = values.components == 1 ? TINYGLTF_TYPE_SCALAR : values.components;
  if (bounds == Bounds::stated) {
    accessor.minValues = values.min;
    accessor.maxValues = values.max;
  }
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

gltf::Model make_model(const FreshMesh& mesh) {
  gltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "fairway";
  model.buffers.emplace_back();
  gltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  for (const FreshMesh::Attribute& attribute : mesh.attributes) {
    const Bounds bounds = attribute.name == "POSITION" ? Bounds::stated : Bounds::left_out;
    primitive.attributes[attribute.name] =
        add_accessor(attribute.values, TINYGLTF_TARGET_ARRAY_BUFFER, bounds, model);
  }
  const auto vertices = static_cast<Index>(mesh.attributes.front().values.count);
  primitive.indices = add_accessor(pack_triangles(mesh.triangles, vertices, ComponentType::u16),
                                   TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, Bounds::left_out, model);
  gltf::Mesh& out = model.meshes.emplace_back();
  out.primitives.push_back(primitive);
  model.nodes.emplace_back().mesh = 0;
  model.scenes.emplace_back().nodes.push_back(0);
  model.defaultScene = 0;
  return model;
}

}  // namespace

Result<std::vector<std::byte>> write_fresh_gltf(const FreshMesh& mesh, Format format) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() / 2;
  std::size_t size = mesh.triangles.size() * sizeof(Triangle);
  for (const FreshMesh::Attribute& attribute : mesh.attributes) {
    size += attribute.values.bytes.size();
  }
  if (size > kMost) return Error{ErrorCode::too_large, "The result does not fit in a GLB."};
  try {
    const gltf::Model model = make_model(mesh);
    ByteSink sink;
    std::ostream stream(&sink);
    gltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, stream, false, format == Format::glb)) {
      return Error{ErrorCode::internal, "The new document could not be written."};
    }
    return sink.take();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::too_large, "Writing the result needs more memory than there is."};
  } catch (const std::exception&) {
    return Error{ErrorCode::internal, "The new document could not be written."};
  }
}

}  // namespace fairway
