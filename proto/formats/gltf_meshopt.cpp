// Meshopt-compressed views of a glTF. Source: EXT_meshopt_compression, KHR_meshopt_compression.

#include "proto/formats/gltf_meshopt.h"

#include <array>
#include <utility>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::array<std::string_view, 2> kExtensions = {"KHR_meshopt_compression",
                                                         "EXT_meshopt_compression"};
/// Decoded bytes of all views together per element that the file may make: views may share bytes.
constexpr std::uint64_t kBytesPerElement = 8;

constexpr std::array<std::pair<std::string_view, MeshoptMode>, 3> kModes = {
    {{"ATTRIBUTES", MeshoptMode::attributes},
     {"TRIANGLES", MeshoptMode::triangles},
     {"INDICES", MeshoptMode::indices}}};
constexpr std::array<std::pair<std::string_view, MeshoptFilter>, 4> kFilters = {
    {{"NONE", MeshoptFilter::none},
     {"OCTAHEDRAL", MeshoptFilter::octahedral},
     {"QUATERNION", MeshoptFilter::quaternion},
     {"EXPONENTIAL", MeshoptFilter::exponential}}};

template <class Named>
auto find_named(const Named& list, std::string_view name) {
  for (const auto& [known, value] : list) {
    if (known == name) return std::optional(value);
  }
  return decltype(std::optional(list.front().second))();
}

Result<std::optional<JsonPlace>> find_extension(const JsonPlace& place) {
  const auto extensions = place.object("extensions");
  if (!extensions) return extensions.error();
  for (const std::string_view name : kExtensions) {
    if (!*extensions || !(*extensions)->has(name)) continue;
    return (*extensions)->object(name);
  }
  return std::optional<JsonPlace>();
}

/// Where the compressed bytes are.
Result<GltfCompression> read_source(const JsonPlace& extension,
                                    const std::vector<GltfBuffer>& buffers) {
  GltfCompression out;
  const auto buffer = extension.required_index("buffer", buffers.size());
  if (!buffer) return buffer.error();
  const auto offset = extension.count_or("byteOffset", 0);
  if (!offset) return offset.error();
  const auto length = extension.required_count("byteLength");
  if (!length) return length.error();
  const auto end = checked_add(*offset, *length);
  if (!end || *end > buffers[*buffer].length) {
    return extension.error("the compressed bytes reach past the end of their buffer.");
  }
  out.buffer = *buffer;
  out.offset = *offset;
  out.length = *length;
  return out;
}

Result<void> read_layout(const JsonPlace& extension, const GltfView& view, GltfCompression& out) {
  const auto mode = extension.text("mode");
  if (!mode) return mode.error();
  const auto filter = extension.text("filter");
  if (!filter) return filter.error();
  const auto count = extension.required_count("count");
  if (!count) return count.error();
  const auto stride = extension.required_count("byteStride");
  if (!stride) return stride.error();
  const auto size = checked_multiply(*count, *stride);
  if (!size || *size != view.length || (view.stride && *view.stride != *stride)) {
    return extension.error("\"count\" and \"byteStride\" differ from those of the view.");
  }
  const auto known_mode = find_named(kModes, *mode);
  const auto known_filter = find_named(kFilters, filter->empty() ? "NONE" : *filter);
  if (known_mode && known_filter) {
    out.layout = MeshoptLayout{*known_mode, *known_filter, *count, *stride};
  }
  return {};
}

Error at_view(Error error, std::size_t view) {
  error.pointer = fmt::format("/bufferViews/{}", view);
  return error;
}

Result<std::vector<std::byte>> decode(const GltfCompression& compression,
                                      const GltfTables& tables) {
  if (!compression.layout) {
    return Error{ErrorCode::unsupported_feature,
                 "It is compressed in a mode or with a filter that fairway does not know; save it "
                 "with another one."};
  }
  const GltfBuffer& buffer = tables.buffers[compression.buffer];
  if (!buffer.data) return Error{ErrorCode::invalid_mesh, "The compressed bytes are not there."};
  return decode_meshopt(buffer.data->subspan(static_cast<std::size_t>(compression.offset),
                                             static_cast<std::size_t>(compression.length)),
                        *compression.layout);
}

Result<void> decode_view(std::size_t index, GltfTables& tables) {
  GltfView& view = tables.views[index];
  if (!view.compression || view.decoded) return {};
  if (view.length > tables.element_limit * kBytesPerElement - tables.decoded_bytes) {
    return at_view({ErrorCode::too_large,
                    "The compressed views hold more than a file of this size may; store shared "
                    "parts once."},
                   index);
  }
  auto bytes = decode(*view.compression, tables);
  if (!bytes) {
    const bool unknown = bytes.error().code == ErrorCode::unsupported_feature;
    if (unknown && tables.buffers[view.buffer].data) return {};
    return at_view(bytes.error(), index);
  }
  tables.decoded_bytes += view.length;
  view.decoded = ByteSpan(tables.owned.emplace_back(*std::move(bytes)));
  return {};
}

}  // namespace

bool is_fallback_buffer(const JsonPlace& buffer) {
  const auto extension = find_extension(buffer);
  if (!extension || !*extension) return false;
  const auto fallback = (*extension)->flag("fallback");
  return fallback && *fallback;
}

Result<std::optional<GltfCompression>> read_compression(const JsonPlace& place,
                                                        const GltfView& view,
                                                        const std::vector<GltfBuffer>& buffers) {
  const auto extension = find_extension(place);
  if (!extension) return extension.error();
  if (!*extension) return std::optional<GltfCompression>();
  auto out = read_source(**extension, buffers);
  if (!out) return out.error();
  if (const auto done = read_layout(**extension, view, *out); !done) return done.error();
  return std::optional(*out);
}

Result<void> decode_views_of(std::size_t accessor, GltfTables& tables) {
  const GltfAccessor& from = tables.accessors[accessor];
  if (from.view) {
    if (auto done = decode_view(*from.view, tables); !done) return done;
  }
  if (!from.sparse) return {};
  if (auto done = decode_view(from.sparse->indices_view, tables); !done) return done;
  return decode_view(from.sparse->values_view, tables);
}

Result<void> decode_views(const TriangleSource& source, GltfTables& tables) {
  if (source.draco) return {};
  for (const char* name : {"POSITION", "NORMAL", "TANGENT"}) {
    const auto accessor = source.attribute(name);
    if (!accessor) continue;
    if (auto done = decode_views_of(*accessor, tables); !done) return done;
  }
  return source.indices ? decode_views_of(*source.indices, tables) : Result<void>();
}

}  // namespace fairway
