// From surfaces to what Draco encodes.

#include "proto/formats/draco_parts.h"

#include <algorithm>

#include <fmt/format.h>

#include "proto/messages/parameters.h"

namespace fairway {
namespace {

/// The values of a floating attribute, which is tight.
std::span<const float> floats_of(const PackedValues& values) {
  return {reinterpret_cast<const float*>(values.bytes.data()), values.bytes.size() / sizeof(float)};
}

/// The attribute TEX_COORD of a mesh without a scene: u and v of each vertex.
DracoPart texture_part(std::span<const float> values, const DracoOptions& options) {
  return {.kind = DracoKind::tex_coord,
          .name = {},
          .components = 2,
          .values = values,
          .grid = make_grid(value_bounds(values, 2), options.texcoord_bits)};
}

/// The attribute COLOR, in sRGB as in PLY.
DracoPart color_part(const ColorValues& colors) {
  return {.kind = DracoKind::color,
          .name = {},
          .components = colors.components,
          .values = pack_srgb_colors(colors)};
}

bool any_zero(std::span<const float> vectors) {
  for (std::size_t i = 0; i + 2 < vectors.size(); i += 3) {
    if (vectors[i] == 0.0F && vectors[i + 1] == 0.0F && vectors[i + 2] == 0.0F) return true;
  }
  return false;
}

}  // namespace

SurfaceGrids make_surface_grids(std::span<const Vec3> positions,
                                std::span<const VertexAttribute> attributes,
                                const DracoOptions& options) {
  SurfaceGrids out;
  out.position = make_grid(value_bounds(positions), options.position_bits);
  out.attributes.reserve(attributes.size());
  for (const VertexAttribute& attribute : attributes) {
    out.attributes.push_back(
        make_grid(value_bounds(attribute.values, attribute.components), options.curvature_bits));
  }
  return out;
}

DracoPart position_part(std::span<const Vec3> positions,
                        const std::optional<QuantizationGrid>& grid) {
  return {
      .kind = DracoKind::position, .name = {}, .components = 3, .values = positions, .grid = grid};
}

DracoPart normal_part(std::span<const Vec3> normals, const DracoOptions& options) {
  DracoPart part{.kind = DracoKind::normal, .name = {}, .components = 3, .values = normals};
  const bool any_zero =
      std::any_of(normals.begin(), normals.end(), [](const Vec3& n) { return n.isZero(0.0); });
  if (!any_zero) part.octahedral_bits = options.normal_bits;
  return part;
}

DracoPart attribute_part(const VertexAttribute& attribute,
                         const std::optional<QuantizationGrid>& grid, Index first, Index count) {
  const auto components = static_cast<std::size_t>(attribute.components);
  return {.kind = DracoKind::generic,
          .name = attribute.name,
          .components = attribute.components,
          .values = std::span(attribute.values).subspan(first * components, count * components),
          .grid = grid};
}

DracoPart color_part(const VertexColors& colors) {
  return {.kind = DracoKind::color,
          .name = {},
          .components = 4,
          .values = pack_srgb_colors(colors.values)};
}

std::string describe_surface(std::string_view name, const SurfaceGrids& grids,
                             std::span<const VertexAttribute> attributes) {
  std::string out = fmt::format("{} as Draco: {}", name, describe_grid("POSITION", grids.position));
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    out += "; " + describe_grid(attributes[i].name, grids.attributes[i]);
  }
  return out;
}

bool is_curvature_name(std::string_view name) {
  return name.starts_with("_CURVATURE_") || name == kFeatureAttribute;
}

DracoKind draco_kind_of(std::string_view gltf_name) {
  if (gltf_name == "POSITION") return DracoKind::position;
  if (gltf_name == "NORMAL") return DracoKind::normal;
  if (gltf_name.starts_with("TEXCOORD_")) return DracoKind::tex_coord;
  if (gltf_name.starts_with("COLOR_")) return DracoKind::color;
  return DracoKind::generic;
}

std::optional<QuantizationGrid> gltf_grid(std::string_view name, const PackedValues& values,
                                          const DracoOptions& options) {
  const bool texture = draco_kind_of(name) == DracoKind::tex_coord;
  if (values.type != ComponentType::f32 || !(texture || is_curvature_name(name))) {
    return std::nullopt;
  }
  return make_grid(value_bounds(floats_of(values), values.components),
                   texture ? options.texcoord_bits : options.curvature_bits);
}

DracoPart gltf_part(std::string_view name, const PackedValues& values,
                    const DracoOptions& options) {
  DracoPart part{.kind = draco_kind_of(name),
                 .name = {},
                 .components = values.components,
                 .values = {},
                 .grid = gltf_grid(name, values, options)};
  if (values.type != ComponentType::f32) {
    part.values = values;
    return part;
  }
  const std::span<const float> floats = floats_of(values);
  part.values = floats;
  if (part.kind == DracoKind::position) {
    part.grid = make_grid(value_bounds(floats, values.components), options.position_bits);
  }
  if (part.kind == DracoKind::normal && !any_zero(floats)) {
    part.octahedral_bits = options.normal_bits;
  }
  return part;
}

Result<Encoded> write_fresh_draco(const Surface& surface, const SurfaceResult& result,
                                  const DracoOptions& options, const VertexExtras& extras) {
  const std::vector<Vec3>& positions = result.moved ? result.positions : surface.mesh.positions;
  const std::vector<Vec3>& normals = result.moved ? result.normals : surface.normals;
  const SurfaceGrids grids = make_surface_grids(positions, result.attributes, options);
  std::string note = describe_surface(surface.name, grids, result.attributes);
  DracoSource source;
  source.triangles = surface.mesh.triangles;
  source.points = static_cast<Index>(positions.size());
  source.parts.push_back(position_part(positions, grids.position));
  if (!normals.empty()) source.parts.push_back(normal_part(normals, options));
  for (std::size_t i = 0; i < result.attributes.size(); ++i) {
    source.parts.push_back(
        attribute_part(result.attributes[i], grids.attributes[i], 0, source.points));
  }
  if (!extras.texture_coordinates.empty()) {
    source.parts.push_back(texture_part(extras.texture_coordinates, options));
    note += "; " + describe_grid("TEX_COORD", source.parts.back().grid);
  }
  if (!extras.colors.empty()) source.parts.push_back(color_part(extras.colors));
  auto stream =
      encode_draco(source, options.level, options.keep_order ? DracoOrder::kept : DracoOrder::free);
  if (!stream) return stream.error();
  return Encoded{ByteChain(std::move(stream->bytes)), {std::move(note)}};
}

}  // namespace fairway
