#pragma once

#include <span>

#include "proto/formats/gltf_surfaces.h"

namespace fairway {

/// The tangents of a primitive (a VEC4 accessor: xyz, and w the handedness, kept), compressed or
/// not, made perpendicular to the new `normals` of its vertices. Errors: those of reading them.
Result<PackedValues> straight_tangents(const GltfTables& tables, const DracoMeshes& draco,
                                       const TriangleSource& source, std::size_t accessor,
                                       std::span<const Vec3> normals);

}  // namespace fairway
