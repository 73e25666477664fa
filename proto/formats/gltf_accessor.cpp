// Values of accessors. Source: glTF 2.0 section 3.6.2. The tables have proved that every element
// lies inside its view, so the loops here read without further checks.

#include "proto/formats/gltf_accessor.h"

#include <fmt/format.h>

namespace fairway {
namespace {

Error accessor_error(std::size_t accessor, std::string_view reason) {
  const std::string pointer = fmt::format("/accessors/{}", accessor);
  return {ErrorCode::invalid_mesh, fmt::format("The glTF is invalid at {}: {}", pointer, reason),
          pointer};
}

/// Where the elements of one view stand.
struct Elements {
  const std::byte* first;
  std::size_t stride;

  const std::byte* operator[](std::uint64_t i) const {
    return first + static_cast<std::size_t>(i) * stride;
  }
};

Result<Elements> elements(const GltfTables& tables, std::size_t view, std::uint64_t offset,
                          std::size_t size) {
  const auto bytes = view_bytes(tables, view);
  if (!bytes) return bytes.error();
  return Elements{bytes->data() + offset,
                  static_cast<std::size_t>(tables.views[view].stride.value_or(size))};
}

void copy_element(const GltfAccessor& accessor, const std::byte* from, double* to) {
  const std::size_t size = size_of(accessor.type);
  for (int c = 0; c < accessor.components; ++c) {
    to[c] = read_component(accessor.type, from + static_cast<std::size_t>(c) * size);
  }
}

Result<void> apply_sparse(const GltfTables& tables, std::size_t index, std::vector<double>& out) {
  const GltfAccessor& accessor = tables.accessors[index];
  const GltfSparse& sparse = *accessor.sparse;
  const auto indices =
      elements(tables, sparse.indices_view, sparse.indices_offset, size_of(sparse.indices_type));
  if (!indices) return indices.error();
  const auto values =
      elements(tables, sparse.values_view, sparse.values_offset, accessor.element_size);
  if (!values) return values.error();
  for (std::uint64_t i = 0; i < sparse.count; ++i) {
    const auto at = static_cast<std::uint64_t>(read_component(sparse.indices_type, (*indices)[i]));
    if (at >= accessor.count) return accessor_error(index, "a sparse index is out of range.");
    copy_element(accessor, (*values)[i],
                 out.data() + at * static_cast<std::uint64_t>(accessor.components));
  }
  return {};
}

}  // namespace

Result<std::vector<double>> read_stored(const GltfTables& tables, std::size_t index) {
  const GltfAccessor& accessor = tables.accessors[index];
  // An accessor without a view costs no bytes, so its count proves nothing.
  if (!accessor.view && accessor.count > tables.element_limit) {
    return accessor_error(index, "more elements are stated than the size of the file allows.");
  }
  const auto components = static_cast<std::size_t>(accessor.components);
  std::vector<double> out(static_cast<std::size_t>(accessor.count) * components, 0.0);
  if (accessor.view) {
    const auto from = elements(tables, *accessor.view, accessor.offset, accessor.element_size);
    if (!from) return from.error();
    for (std::uint64_t i = 0; i < accessor.count; ++i) {
      copy_element(accessor, (*from)[i], out.data() + i * components);
    }
  }
  if (accessor.sparse) {
    if (const auto done = apply_sparse(tables, index, out); !done) return done.error();
  }
  return out;
}

Result<std::vector<double>> read_values(const GltfTables& tables, std::size_t index) {
  auto out = read_stored(tables, index);
  const GltfAccessor& accessor = tables.accessors[index];
  if (!out || !accessor.normalized) return out;
  for (double& value : *out) value = decode_component({accessor.type, true}, value);
  return out;
}

Result<std::vector<Index>> read_indices(const GltfTables& tables, std::size_t index) {
  const GltfAccessor& accessor = tables.accessors[index];
  const bool is_unsigned = accessor.type == ComponentType::u8 ||
                           accessor.type == ComponentType::u16 ||
                           accessor.type == ComponentType::u32;
  if (!accessor.is_scalar() || !is_unsigned || accessor.normalized) {
    return accessor_error(index, "indices are scalars of an unsigned integer type.");
  }
  const auto values = read_stored(tables, index);
  if (!values) return values.error();
  std::vector<Index> out;
  out.reserve(values->size());
  for (const double value : *values) out.push_back(static_cast<Index>(value));
  return out;
}

}  // namespace fairway
