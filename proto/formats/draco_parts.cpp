// From surfaces to what Draco encodes.

#include "proto/formats/draco_parts.h"

#include <algorithm>

#include <fmt/format.h>

#include "proto/messages/parameters.h"

namespace fairway {

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

Result<Encoded> write_fresh_draco(const Surface& surface, const SurfaceResult& result,
                                  const DracoOptions& options) {
  const std::vector<Vec3>& positions = result.moved ? result.positions : surface.mesh.positions;
  const std::vector<Vec3>& normals = result.moved ? result.normals : surface.normals;
  const SurfaceGrids grids = make_surface_grids(positions, result.attributes, options);
  DracoSource source;
  source.triangles = surface.mesh.triangles;
  source.points = static_cast<Index>(positions.size());
  source.parts.push_back(position_part(positions, grids.position));
  if (!normals.empty()) source.parts.push_back(normal_part(normals, options));
  for (std::size_t i = 0; i < result.attributes.size(); ++i) {
    source.parts.push_back(
        attribute_part(result.attributes[i], grids.attributes[i], 0, source.points));
  }
  auto stream =
      encode_draco(source, options.level, options.keep_order ? DracoOrder::kept : DracoOrder::free);
  if (!stream) return stream.error();
  return Encoded{std::move(stream->bytes),
                 {describe_surface(surface.name, grids, result.attributes)}};
}

}  // namespace fairway
