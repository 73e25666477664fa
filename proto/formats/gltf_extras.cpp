// COLOR_0 and TEXCOORD_0 of a surface's vertices. Source: glTF 2.0 section 3.7.2.1.

#include "proto/formats/gltf_extras.h"

#include <optional>
#include <string_view>

#include "proto/formats/gltf_accessor.h"
#include "proto/formats/gltf_meshopt.h"

namespace fairway {
namespace {

constexpr std::string_view kColors = "COLOR_0";
constexpr std::string_view kTextureCoordinates = "TEXCOORD_0";

/// Where one block of vertices has an attribute.
struct BlockSource {
  std::size_t accessor = 0;
  std::optional<std::uint64_t> draco_id;

  bool operator==(const BlockSource&) const = default;
};

std::optional<BlockSource> source_of(const SurfacePrimitive& primitive, std::string_view name) {
  const auto accessor = primitive.source.attribute(name);
  if (!accessor) return std::nullopt;
  BlockSource out{*accessor, std::nullopt};
  if (primitive.source.draco) {
    const auto id = primitive.source.draco->ids.find(name);
    if (id != primitive.source.draco->ids.end()) out.draco_id = id->second;
  }
  return out;
}

/// One per block; empty where a primitive has none or two share vertices but not the attribute.
std::vector<BlockSource> sources_of(const SurfacePlan& plan, std::string_view name) {
  std::vector<std::optional<BlockSource>> found(plan.blocks.size());
  for (const SurfacePrimitive& primitive : plan.primitives) {
    const auto source = source_of(primitive, name);
    std::optional<BlockSource>& of_block = found[primitive.block];
    if (!source || (of_block && of_block != source)) return {};
    of_block = source;
  }
  std::vector<BlockSource> out;
  out.reserve(found.size());
  for (const auto& source : found) out.push_back(*source);
  return out;
}

bool holds_color(const GltfAccessor& accessor) {
  const bool small = accessor.type == ComponentType::u8 || accessor.type == ComponentType::u16;
  return (accessor.is_vector(3) || accessor.is_vector(4)) &&
         (accessor.type == ComponentType::f32 || (small && accessor.normalized));
}

/// The components that the colours of all blocks have, 0 where they differ.
int color_components(const GltfTables& tables, const std::vector<BlockSource>& sources) {
  int out = 0;
  for (const BlockSource& source : sources) {
    const GltfAccessor& accessor = tables.accessors[source.accessor];
    if (!holds_color(accessor) || (out != 0 && accessor.components != out)) return 0;
    out = accessor.components;
  }
  return out;
}

bool hold_texture_coordinates(const GltfTables& tables, const std::vector<BlockSource>& sources) {
  for (const BlockSource& source : sources) {
    if (!tables.accessors[source.accessor].is_vector(2)) return false;
  }
  return !sources.empty();
}

Result<std::vector<double>> read_block(const GltfTables& tables, const GltfLayout& layout,
                                       const VertexBlock& block, const BlockSource& source) {
  if (!source.draco_id) return read_values(tables, source.accessor);
  const DracoMesh& mesh = layout.draco_meshes.at(*block.draco_view);
  return draco_values(mesh, *mesh.find_unique(*source.draco_id), tables.accessors[source.accessor]);
}

/// The values of an attribute that all blocks have, block after block.
Result<std::vector<double>> read_attribute(const GltfTables& tables, const GltfLayout& layout,
                                           const SurfacePlan& plan, std::string_view name) {
  // What has to be decoded for this is not kept.
  GltfTables decoded = without_owned(tables);
  const std::vector<BlockSource> sources = sources_of(plan, name);
  std::vector<double> out;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!sources[i].draco_id) {
      if (auto done = decode_views_of(sources[i].accessor, decoded); !done) return done.error();
    }
    auto values = read_block(decoded, layout, plan.blocks[i], sources[i]);
    if (!values) return values.error();
    if (out.empty()) {
      out = *std::move(values);
    } else {
      out.insert(out.end(), values->begin(), values->end());
    }
  }
  return out;
}

}  // namespace

ExtraKinds gltf_extra_kinds(const GltfTables& tables, const SurfacePlan& plan) {
  return {color_components(tables, sources_of(plan, kColors)),
          hold_texture_coordinates(tables, sources_of(plan, kTextureCoordinates))};
}

Result<ColorValues> read_gltf_colors(const GltfTables& tables, const GltfLayout& layout,
                                     const SurfacePlan& plan) {
  auto values = read_attribute(tables, layout, plan, kColors);
  if (!values) return values.error();
  return make_colors_from_linear(*std::move(values),
                                 gltf_extra_kinds(tables, plan).color_components);
}

Result<std::vector<float>> read_gltf_texture_coordinates(const GltfTables& tables,
                                                         const GltfLayout& layout,
                                                         const SurfacePlan& plan) {
  auto values = read_attribute(tables, layout, plan, kTextureCoordinates);
  if (!values) return values.error();
  return make_texture_coordinates_from_top(*std::move(values));
}

}  // namespace fairway
