// New glTF documents with a compressed primitive. They are built by adding to an empty document, as
// those that come as glTF are: the writer of the plain ones knows no fallback buffers.

#include "proto/formats/fresh_compression.h"

#include <fmt/format.h>

#include "proto/formats/draco_parts.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_output.h"

namespace fairway {
namespace {

/// A document with a scene and a node of mesh 0, which is still to come, and an empty BIN.
Json empty_document() {
  Json json = Json::object();
  json["asset"] = {{"version", "2.0"}, {"generator", "fairway"}};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  json["nodes"] = Json::array({{{"mesh", 0}}});
  json["meshes"] = Json::array();
  json["accessors"] = Json::array();
  json["bufferViews"] = Json::array();
  json["buffers"] = Json::array({{{"byteLength", 0}}});
  return json;
}

GltfBinary empty_binary() {
  GltfBinary out;
  out.is_glb = true;
  out.bin = ByteSpan();
  out.first_buffer = ByteSpan();
  return out;
}

/// What a label says of the values.
PackedValues label_of(const PackedValues& values) {
  PackedValues out;
  out.type = values.type;
  out.normalized = values.normalized;
  out.components = values.components;
  out.min = values.min;
  out.max = values.max;
  return out;
}

Bounds bounds_of(std::string_view name) {
  return name == "POSITION" ? Bounds::stated : Bounds::left_out;
}

Json meshopt_primitive(const FreshMesh& mesh, GltfOutput& output) {
  Json attributes = Json::object();
  for (const auto& [name, values] : mesh.attributes) {
    attributes[name] =
        output.add_accessor(values, {ViewTarget::vertices, bounds_of(name), ViewCoding::meshopt});
  }
  const auto vertices = static_cast<Index>(mesh.attributes.front().values.count);
  const std::size_t indices =
      output.add_accessor(pack_triangles(mesh.triangles, vertices, ComponentType::u16),
                          {ViewTarget::indices, Bounds::left_out, ViewCoding::meshopt});
  Json out = Json::object();
  out["attributes"] = std::move(attributes);
  out["indices"] = indices;
  out["mode"] = 4;
  return out;
}

/// The least and greatest values that a reader of the stream will find.
void round_bounds(const QuantizationGrid& grid, PackedValues& values) {
  for (std::size_t c = 0; c < values.min.size(); ++c) {
    values.min[c] = static_cast<double>(grid.rounded(static_cast<float>(values.min[c]), c));
    values.max[c] = static_cast<double>(grid.rounded(static_cast<float>(values.max[c]), c));
  }
}

Json draco_primitive(const FreshMesh& mesh, const DracoSource& source, const DracoStream& stream,
                     GltfOutput& output) {
  Json attributes = Json::object();
  Json ids = Json::object();
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const std::string& name = mesh.attributes[i].name;
    PackedValues shape = label_of(mesh.attributes[i].values);
    shape.count = stream.points;
    if (source.parts[i].grid) round_bounds(*source.parts[i].grid, shape);
    attributes[name] = output.label(std::nullopt, shape, bounds_of(name));
    ids[name] = stream.unique_ids[i];
  }
  PackedValues shape;
  shape.type = stream.points > 0xFFFF ? ComponentType::u32 : ComponentType::u16;
  shape.count = stream.triangles * 3;
  Json out = Json::object();
  out["attributes"] = std::move(attributes);
  out["indices"] = output.label(std::nullopt, shape, Bounds::left_out);
  out["mode"] = 4;
  Json& extension = out["extensions"][kDracoExtension];
  extension["bufferView"] = output.add_stream(stream.bytes);
  extension["attributes"] = std::move(ids);
  return out;
}

DracoSource draco_source(const FreshMesh& mesh, const DracoOptions& options) {
  DracoSource out;
  out.triangles = mesh.triangles;
  out.points = static_cast<Index>(mesh.attributes.front().values.count);
  for (const auto& [name, values] : mesh.attributes) {
    out.parts.push_back(gltf_part(name, values, options));
  }
  return out;
}

std::string describe(std::string_view surface, const FreshMesh& mesh, const DracoSource& source) {
  std::string out = fmt::format("{} as Draco", surface);
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const std::string& name = mesh.attributes[i].name;
    if (name == "NORMAL" || (!source.parts[i].grid && !is_curvature_name(name))) continue;
    out += (i == 0 ? ": " : "; ") + describe_grid(name, source.parts[i].grid);
  }
  return out;
}

Result<Encoded> finish(GltfOutput& output, Json primitive, std::vector<std::string> notes) {
  Json mesh = Json::object();
  mesh["primitives"] = Json::array({std::move(primitive)});
  output.json()["meshes"].push_back(std::move(mesh));
  auto bytes = output.finish();
  if (!bytes) return bytes.error();
  return Encoded{*std::move(bytes), std::move(notes)};
}

}  // namespace

Result<Encoded> write_fresh_gltf(const FreshMesh& mesh, Format format, const Encoding& encoding,
                                 std::string_view name) {
  const bool draco = encoding.compression == Compression::draco;
  if (!draco && encoding.compression != Compression::meshopt) {
    auto bytes = write_fresh_gltf(mesh, format);
    if (!bytes) return bytes.error();
    return Encoded{ByteChain(*std::move(bytes)), {}};
  }
  const GltfBinary binary = empty_binary();
  GltfOutput output(empty_document(), binary, format);
  if (!draco) return finish(output, meshopt_primitive(mesh, output), {});
  const DracoSource source = draco_source(mesh, encoding.draco);
  const auto stream = encode_draco(source, encoding.draco.level,
                                   encoding.draco.keep_order ? DracoOrder::kept : DracoOrder::free);
  if (!stream) return stream.error();
  Json primitive = draco_primitive(mesh, source, *stream, output);
  require_extension(kDracoExtension, output.json());
  return finish(output, std::move(primitive), {describe(name, mesh, source)});
}

}  // namespace fairway
