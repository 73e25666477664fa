// Buffers, buffer views and accessors of an untrusted glTF. Source: glTF 2.0 sections 3.6.1, 3.6.2.
// Every number is checked against the bytes that are there before it is used.

#include "proto/formats/gltf_tables.h"

#include <fmt/format.h>

#include "proto/formats/gltf_meshopt.h"
#include "proto/messages/base64.h"

namespace fairway {
namespace {

/// Elements per byte of the file that sharing and sparse accessors may make.
constexpr std::uint64_t kElementsPerByte = 8;
constexpr std::uint64_t kMinStride = 4;
constexpr std::uint64_t kMaxStride = 252;

Result<ByteSpan> data_of_uri(const JsonPlace& buffer, std::string_view uri, GltfTables& tables) {
  const auto payload = data_uri_payload(uri);
  auto bytes = payload ? decode_base64(*payload) : std::nullopt;
  if (!bytes) return buffer.error_at("uri", "the data URI is not whole base64; encode it again.");
  return ByteSpan(tables.owned.emplace_back(std::move(*bytes)));
}

/// The bytes of a buffer wherever they stand. Nothing where it needs none.
Result<std::optional<ByteSpan>> find_data(const JsonPlace& place, std::optional<ByteSpan> bin,
                                          GltfTables& tables, SideReader& side_files) {
  const auto uri = place.text("uri");
  if (!uri) return uri.error();
  if (place.has("uri")) {
    const auto data =
        is_data_uri(*uri) ? data_of_uri(place, *uri, tables) : side_files.read(place, *uri);
    if (data) return std::optional(*data);
    const bool needed = is_data_uri(*uri) || !is_fallback_buffer(place);
    if (needed || data.error().code == ErrorCode::too_large) return data.error();
    return std::optional<ByteSpan>();
  }
  if (bin || is_fallback_buffer(place)) return bin;
  return place.error("this buffer has no data; send a GLB or embed it as a data URI.");
}

Result<GltfBuffer> read_buffer(const JsonPlace& place, std::optional<ByteSpan> bin,
                               GltfTables& tables, SideReader& side_files) {
  const auto length = place.required_count("byteLength");
  if (!length) return length.error();
  const auto data = find_data(place, bin, tables, side_files);
  if (!data) return data.error();
  GltfBuffer buffer{*length, *data};
  if (!buffer.data) return buffer;
  const auto uri = place.text("uri");
  buffer.is_side_file = uri && place.has("uri") && !is_data_uri(*uri);
  if (buffer.data->size() < *length) {
    return place.error_at("byteLength", fmt::format("{} bytes are stated, {} are there.", *length,
                                                    buffer.data->size()));
  }
  buffer.data = buffer.data->first(static_cast<std::size_t>(*length));
  return buffer;
}

Result<GltfView> read_view(const JsonPlace& place, const GltfTables& tables) {
  const auto buffer = place.required_index("buffer", tables.buffers.size());
  if (!buffer) return buffer.error();
  const auto offset = place.count_or("byteOffset", 0);
  if (!offset) return offset.error();
  const auto length = place.required_count("byteLength");
  if (!length) return length.error();
  const auto stride = place.count("byteStride");
  if (!stride) return stride.error();
  if (*stride && (**stride < kMinStride || **stride > kMaxStride)) {
    return place.error_at("byteStride", "a stride is 4 to 252 bytes.");
  }
  const auto end = checked_add(*offset, *length);
  if (!end || *end > tables.buffers[*buffer].length) {
    return place.error("this view reaches past the end of its buffer.");
  }
  GltfView view{*buffer, *offset, *length, *stride};
  const auto compression = read_compression(place, view, tables.buffers);
  if (!compression) return compression.error();
  view.compression = *compression;
  return view;
}

Result<ComponentType> read_component_type(const JsonPlace& place) {
  const auto number = place.required_count("componentType");
  if (!number) return number.error();
  const auto type = component_type_of(*number);
  if (!type) return place.error_at("componentType", "there is no such component type.");
  return *type;
}

/// `count` elements of `size` at `offset` of a view must be there.
bool fits(const GltfView& view, std::uint64_t offset, std::uint64_t count, std::uint64_t size) {
  const auto end = strided_end(offset, count, view.stride.value_or(size), size);
  return end && *end <= view.length;
}

Result<GltfSparse> read_sparse(const JsonPlace& place, const GltfAccessor& accessor,
                               const GltfTables& tables) {
  const auto indices = place.object("indices");
  if (!indices) return indices.error();
  const auto values = place.object("values");
  if (!values) return values.error();
  if (!*indices || !*values) return place.error("\"indices\" and \"values\" are both needed.");
  const auto count = place.required_count("count");
  if (!count) return count.error();
  const auto indices_view = (*indices)->required_index("bufferView", tables.views.size());
  if (!indices_view) return indices_view.error();
  const auto values_view = (*values)->required_index("bufferView", tables.views.size());
  if (!values_view) return values_view.error();
  const auto indices_offset = (*indices)->count_or("byteOffset", 0);
  if (!indices_offset) return indices_offset.error();
  const auto values_offset = (*values)->count_or("byteOffset", 0);
  if (!values_offset) return values_offset.error();
  const auto type = read_component_type(**indices);
  if (!type) return type.error();
  if (*type != ComponentType::u8 && *type != ComponentType::u16 && *type != ComponentType::u32) {
    return (*indices)->error_at("componentType", "indices are unsigned integers.");
  }
  if (*count == 0 || *count > accessor.count ||
      !fits(tables.views[*indices_view], *indices_offset, *count, size_of(*type)) ||
      !fits(tables.views[*values_view], *values_offset, *count, accessor.element_size)) {
    return place.error_at("count", "more elements are stated than there are.");
  }
  return GltfSparse{*count, *indices_view, *indices_offset, *type, *values_view, *values_offset};
}

Result<GltfAccessor> read_shape(const JsonPlace& place) {
  GltfAccessor accessor;
  const auto type = read_component_type(place);
  if (!type) return type.error();
  const auto name = place.text("type");
  if (!name) return name.error();
  accessor.components = components_of_type_name(*name);
  if (accessor.components == 0) return place.error_at("type", "there is no such type.");
  const auto normalized = place.flag("normalized");
  if (!normalized) return normalized.error();
  const auto count = place.required_count("count");
  if (!count) return count.error();
  if (*count == 0) return place.error_at("count", "an accessor has one element or more.");
  accessor.type = *type;
  accessor.normalized = *normalized;
  accessor.matrix = name->starts_with("MAT");
  accessor.element_size = element_size(*type, *name);
  accessor.count = *count;
  return accessor;
}

Result<GltfAccessor> read_accessor(const JsonPlace& place, const GltfTables& tables) {
  auto accessor = read_shape(place);
  if (!accessor) return accessor.error();
  const auto view = place.index("bufferView", tables.views.size());
  if (!view) return view.error();
  const auto offset = place.count_or("byteOffset", 0);
  if (!offset) return offset.error();
  accessor->view = *view;
  accessor->offset = *offset;
  if (*view) {
    const GltfView& from = tables.views[**view];
    if (from.stride && *from.stride < accessor->element_size) {
      return place.error("the stride of its view is shorter than an element.");
    }
    if (!fits(from, *offset, accessor->count, accessor->element_size)) {
      return place.error("this accessor reaches past the end of its view.");
    }
  }
  const auto sparse = place.object("sparse");
  if (!sparse) return sparse.error();
  if (*sparse) {
    const auto read = read_sparse(**sparse, *accessor, tables);
    if (!read) return read.error();
    accessor->sparse = *read;
  }
  return accessor;
}

/// Every element of the array at `key` through `read`, into `out`.
template <class T, class Read>
Result<void> read_all(const JsonPlace& root, std::string_view key, std::vector<T>& out,
                      const Read& read) {
  const auto list = root.array(key);
  if (!list) return list.error();
  if (!*list) return {};
  out.reserve((*list)->size());
  for (std::size_t i = 0; i < (*list)->size(); ++i) {
    const JsonPlace place = (**list)[i];
    if (!place.json().is_object()) return place.error("this must be an object.");
    auto item = read(place);
    if (!item) return item.error();
    out.push_back(*std::move(item));
  }
  return {};
}

}  // namespace

Result<GltfTables> read_tables(const JsonPlace& root, std::optional<ByteSpan> bin,
                               std::uint64_t input_size, SideReader& side_files) {
  GltfTables tables;
  const auto buffer = [&](const JsonPlace& place) {
    return read_buffer(place, tables.buffers.empty() ? bin : std::nullopt, tables, side_files);
  };
  if (const auto done = read_all(root, "buffers", tables.buffers, buffer); !done) {
    return done.error();
  }
  tables.element_limit = (input_size + side_files.total()) * kElementsPerByte;
  const auto view = [&](const JsonPlace& place) { return read_view(place, tables); };
  if (const auto done = read_all(root, "bufferViews", tables.views, view); !done) {
    return done.error();
  }
  const auto accessor = [&](const JsonPlace& place) { return read_accessor(place, tables); };
  if (const auto done = read_all(root, "accessors", tables.accessors, accessor); !done) {
    return done.error();
  }
  return tables;
}

GltfTables without_owned(const GltfTables& tables) {
  return {tables.buffers,       tables.views,        tables.accessors, {},
          tables.element_limit, tables.decoded_bytes};
}

Result<ByteSpan> view_bytes(const GltfTables& tables, std::size_t view) {
  const GltfView& from = tables.views[view];
  if (from.decoded) return *from.decoded;
  const GltfBuffer& buffer = tables.buffers[from.buffer];
  if (!buffer.data) {
    return Error{ErrorCode::unsupported_feature,
                 "The buffer of this view has no data and the view is not compressed as fairway "
                 "reads it; send the mesh uncompressed.",
                 fmt::format("/bufferViews/{}", view)};
  }
  return buffer.data->subspan(static_cast<std::size_t>(from.offset),
                              static_cast<std::size_t>(from.length));
}

}  // namespace fairway
