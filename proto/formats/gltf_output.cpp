// Writing a glTF by adding to it. Source: glTF 2.0 sections 3.6 and 4.4.

#include "proto/formats/gltf_output.h"

#include "proto/formats/glb.h"
#include "proto/formats/meshopt_encoder.h"
#include "proto/messages/base64.h"

namespace fairway {
namespace {

bool has_uri(const Json& json, std::size_t buffer) {
  const auto buffers = json.find("buffers");
  return buffers != json.end() && buffer < buffers->size() && (*buffers)[buffer].contains("uri");
}

/// buffers[0] is, or becomes, the BIN chunk of the output, or the data URI that BIN turns into.
bool extends_first_buffer(const Json& json, const GltfBinary& binary, Format format) {
  if (!binary.first_buffer) return false;
  const bool is_bin = binary.is_glb && binary.bin && !has_uri(json, 0);
  return is_bin || (!binary.is_glb && format == Format::glb);
}

Json bounds_of(const std::vector<double>& values, ComponentType type) {
  Json out = Json::array();
  for (const double value : values) {
    if (type == ComponentType::f32) {
      out.push_back(value);
    } else {
      out.push_back(static_cast<std::int64_t>(value));
    }
  }
  return out;
}

void describe(const PackedValues& values, std::optional<std::size_t> view, Bounds bounds,
              Json& accessor) {
  if (view) {
    accessor["bufferView"] = *view;
  } else {
    accessor.erase("bufferView");
  }
  accessor.erase("byteOffset");
  accessor.erase("sparse");
  accessor["componentType"] = static_cast<unsigned>(values.type);
  accessor.erase("normalized");
  if (values.normalized) accessor["normalized"] = true;
  accessor["count"] = values.count;
  accessor["type"] = vector_type_name(values.components);
  accessor.erase("min");
  accessor.erase("max");
  if (bounds == Bounds::left_out) return;
  accessor["min"] = bounds_of(values.min, values.type);
  accessor["max"] = bounds_of(values.max, values.type);
}

}  // namespace

GltfOutput::GltfOutput(const Json& json, const GltfBinary& binary, Format format)
    : json_(json),
      binary_(binary),
      format_(format),
      extends_first_(extends_first_buffer(json, binary, format)) {
  const JsonPlace root(json_, "");
  // Which of the two a reader of this file is sure to know.
  if (uses_extension(root, kNewerMeshoptExtension) && !uses_extension(root, kMeshoptExtension)) {
    meshopt_extension_ = kNewerMeshoptExtension;
  }
  if (extends_first_) {
    data_.append_view(binary.is_glb ? *binary.bin : *binary.first_buffer);
    old_size_ = data_.size();
  } else {
    const auto buffers = json_.find("buffers");
    buffer_ = buffers == json_.end() ? 0 : buffers->size();
  }
}

/// Adds a view of the next bytes, which this returns: the last one.
Json& GltfOutput::add_view_of(std::size_t size) {
  data_.align_to_four();
  Json view = Json::object();
  view["buffer"] = buffer_;
  view["byteOffset"] = data_.size();
  view["byteLength"] = size;
  Json& views = array_of(json_, "bufferViews");
  views.push_back(std::move(view));
  return views.back();
}

Json& GltfOutput::add_bytes(std::vector<std::byte> bytes) {
  Json& view = add_view_of(bytes.size());
  data_.append(std::move(bytes));
  return view;
}

/// Appends the values as a meshopt stream and a view that stands in the fallback buffer; false
/// where a stream cannot hold them.
bool GltfOutput::add_compressed(const PackedValues& values, ViewTarget target) {
  const bool indices = target == ViewTarget::indices;
  const MeshoptLayout layout{indices ? MeshoptMode::indices : MeshoptMode::attributes,
                             MeshoptFilter::none, values.count, values.stride};
  std::vector<std::byte> stream = encode_meshopt(values.stored(), layout);
  if (stream.empty()) return false;
  const std::size_t new_buffer = extends_first_ ? 0 : 1;
  const auto buffers = json_.find("buffers");
  const std::size_t fallback = (buffers == json_.end() ? 0 : buffers->size()) + new_buffer;
  Json& view = add_bytes(std::move(stream));
  Json extension = {{"buffer", view["buffer"]},
                    {"byteOffset", view["byteOffset"]},
                    {"byteLength", view["byteLength"]},
                    {"byteStride", layout.stride},
                    {"mode", indices ? "INDICES" : "ATTRIBUTES"},
                    {"count", layout.count}};
  fallback_ = (fallback_ + 3) / 4 * 4;
  view["buffer"] = fallback;
  view["byteOffset"] = fallback_;
  view["byteLength"] = values.stored().size();
  fallback_ += values.stored().size();
  view["extensions"][meshopt_extension_] = std::move(extension);
  return true;
}

/// Takes the bytes out of `values`.
std::size_t GltfOutput::add_view(PackedValues& values, const ViewUse& use) {
  if (use.coding == ViewCoding::plain || !add_compressed(values, use.target)) {
    add_view_of(values.stored().size());
    if (values.borrowed.empty()) {
      data_.append(std::move(values.bytes));
    } else {
      data_.append_view(values.borrowed);
    }
  }
  Json& view = json_["bufferViews"].back();
  if (!values.is_tight()) view["byteStride"] = values.stride;
  view["target"] = static_cast<unsigned>(use.target);
  return json_["bufferViews"].size() - 1;
}

std::size_t GltfOutput::add_stream(std::vector<std::byte> bytes) {
  add_bytes(std::move(bytes));
  return json_["bufferViews"].size() - 1;
}

std::size_t GltfOutput::add_accessor(PackedValues values, const ViewUse& use) {
  Json accessor = Json::object();
  const std::size_t view = add_view(values, use);
  describe(values, view, use.bounds, accessor);
  Json& accessors = array_of(json_, "accessors");
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

void GltfOutput::fill_accessor(std::size_t index, PackedValues values, const ViewUse& use) {
  const std::size_t view = add_view(values, use);
  describe(values, view, use.bounds, json_["accessors"][index]);
}

std::size_t GltfOutput::label(std::optional<std::size_t> index, const PackedValues& values,
                              Bounds bounds) {
  Json& accessors = array_of(json_, "accessors");
  if (!index) accessors.push_back(Json::object());
  const std::size_t at = index.value_or(accessors.size() - 1);
  describe(values, std::nullopt, bounds, accessors[at]);
  return at;
}

/// Into BIN where there is one and readers can know the type, else as text.
void GltfOutput::embed_image(const SideImage& image) {
  Json& json = json_["images"][image.index];
  const bool typed = json.contains("mimeType") || !image_media_type(image.bytes).empty();
  if (format_ != Format::glb || !extends_first_ || !typed || image.bytes.empty()) {
    json["uri"] = make_data_uri(image.bytes, image.media_type);
    return;
  }
  add_view_of(image.bytes.size());
  data_.append_view(image.bytes);
  // A first view is a new key of the document, which moves what `json` refers to.
  Json& moved = json_["images"][image.index];
  moved.erase("uri");
  moved["bufferView"] = json_["bufferViews"].size() - 1;
  moved["mimeType"] = image.media_type;
}

void GltfOutput::embed_side_files() {
  for (const SideBuffer& buffer : binary_.side_buffers) {
    if (extends_first_ && buffer.index == 0) continue;
    json_["buffers"][buffer.index]["uri"] = make_data_uri(buffer.bytes);
  }
  for (const SideImage& image : binary_.side_images) embed_image(image);
}

void GltfOutput::close_first_buffer() {
  Json& buffer = json_["buffers"][0];
  const bool grown = data_.size() > old_size_;
  if (grown) buffer["byteLength"] = data_.size();
  if (format_ == Format::glb) {
    buffer.erase("uri");
  } else {
    // BIN may be padded beyond the buffer it holds.
    buffer["uri"] = make_data_uri(grown ? data_.joined() : *binary_.first_buffer);
  }
}

void GltfOutput::close_new_buffer() {
  if (data_.size() == 0) return;
  Json buffer = Json::object();
  buffer["byteLength"] = data_.size();
  buffer["uri"] = make_data_uri(data_.joined());
  array_of(json_, "buffers").push_back(std::move(buffer));
}

/// The buffer that stands for what the compressed views decode to.
void GltfOutput::close_fallback() {
  if (fallback_ == 0) return;
  Json buffer = Json::object();
  buffer["byteLength"] = fallback_;
  buffer["extensions"][meshopt_extension_]["fallback"] = true;
  array_of(json_, "buffers").push_back(std::move(buffer));
  // Last, because a new key of the root moves all that stands in it.
  require_extension(meshopt_extension_, json_);
}

Result<ByteChain> GltfOutput::finish() {
  embed_side_files();
  ByteChain old_bin;
  if (extends_first_) {
    close_first_buffer();
  } else {
    close_new_buffer();
    if (binary_.bin) old_bin.append_view(*binary_.bin);
  }
  close_fallback();
  std::string text = dump_json(json_);
  if (format_ == Format::glb) {
    const bool has_bin = extends_first_ || binary_.bin;
    const ByteChain& bin = extends_first_ ? data_ : old_bin;
    return build_glb(std::move(text), has_bin ? &bin : nullptr, binary_.other_chunks);
  }
  ByteChain out;
  out.append(std::move(text));
  return out;
}

}  // namespace fairway
