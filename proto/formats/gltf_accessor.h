#pragma once

#include <vector>

#include "proto/formats/gltf_tables.h"

namespace fairway {

/// All components of an accessor, element after element, as the values they stand for (normalized
/// integers decoded), sparse elements in place. `accessor` is a vector or scalar. Errors:
/// invalid_mesh, unsupported_feature.
Result<std::vector<double>> read_values(const GltfTables& tables, std::size_t accessor);

/// The same as they are stored: integers stay integers.
Result<std::vector<double>> read_stored(const GltfTables& tables, std::size_t accessor);

/// An accessor of unsigned scalars.
Result<std::vector<Index>> read_indices(const GltfTables& tables, std::size_t accessor);

}  // namespace fairway
