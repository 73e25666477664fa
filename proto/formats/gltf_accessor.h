#pragma once

#include <vector>

#include "proto/formats/gltf_tables.h"

namespace fairway {

/// All components of an accessor, element after element, as the values they stand for (normalized
/// integers decoded), sparse elements in place. `accessor` is a vector or scalar. Errors:
/// invalid_mesh, unsupported_feature.
Result<std::vector<double>> read_values(const GltfTables& tables, std::size_t accessor);

/// Appends the elements of a VEC3 in the same way, without an intermediate copy. Returns whether
/// they are finite.
Result<bool> append_vectors(const GltfTables& tables, std::size_t accessor, std::vector<Vec3>& out);

/// The same as they are stored: integers stay integers.
Result<std::vector<double>> read_stored(const GltfTables& tables, std::size_t accessor);

/// An accessor of unsigned scalars.
Result<std::vector<Index>> read_indices(const GltfTables& tables, std::size_t accessor);
/// The same by threes; the count must be a multiple of three, not 0.
Result<std::vector<Triangle>> read_index_triples(const GltfTables& tables, std::size_t accessor);

}  // namespace fairway
