#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/document.h"
#include "proto/formats/draco_encoder.h"
#include "proto/messages/encoding.h"

namespace fairway {

/// The grids that one surface's vertices are rounded to, whatever meshes they are stored in: copies
/// of a vertex stay equal.
struct SurfaceGrids {
  std::optional<QuantizationGrid> position;
  std::vector<std::optional<QuantizationGrid>> attributes;  ///< of the result, in its order
};
SurfaceGrids make_surface_grids(std::span<const Vec3> positions,
                                std::span<const VertexAttribute> attributes,
                                const DracoOptions& options);

DracoPart position_part(std::span<const Vec3> positions,
                        const std::optional<QuantizationGrid>& grid);

/// Unit normals; as they are where one of them is zero, which octahedral coordinates cannot say.
DracoPart normal_part(std::span<const Vec3> normals, const DracoOptions& options);

/// `count` vertices of an attribute from `first` on, as a generic attribute that is named by its
/// metadata.
DracoPart attribute_part(const VertexAttribute& attribute,
                         const std::optional<QuantizationGrid>& grid, Index first, Index count);

/// The attribute COLOR of a mesh without a scene, in sRGB as in PLY.
DracoPart color_part(const VertexColors& colors);

/// What is told of a stored surface: the largest errors of its positions and attributes.
std::string describe_surface(std::string_view name, const SurfaceGrids& grids,
                             std::span<const VertexAttribute> attributes);

/// One of fairway's own attributes, by its name.
bool is_curvature_name(std::string_view name);

/// What an attribute of a glTF is to Draco, by its name there.
DracoKind draco_kind_of(std::string_view gltf_name);

/// The grid of a glTF attribute's values: floating texture coordinates and curvature are rounded.
/// Nothing for all else.
std::optional<QuantizationGrid> gltf_grid(std::string_view name, const PackedValues& values,
                                          const DracoOptions& options);

/// A whole attribute of a new glTF, positions and normals included. `values` must outlive it.
DracoPart gltf_part(std::string_view name, const PackedValues& values, const DracoOptions& options);

/// A new .drc around one surface with the attributes of `result` (its colours must be in `extras`).
/// Errors: those of encode_draco().
Result<Encoded> write_fresh_draco(const Surface& surface, const SurfaceResult& result,
                                  const DracoOptions& options, const VertexExtras& extras = {});

}  // namespace fairway
