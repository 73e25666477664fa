// Values of accessors. Source: glTF 2.0 section 3.6.2. The tables have proved that every element
// lies inside its view, so the loops here read without further checks.

#include "proto/formats/gltf_accessor.h"

#include <algorithm>

#include <fmt/format.h>

#include "proto/formats/finite.h"

namespace fairway {
namespace {

Error accessor_error(std::size_t accessor, std::string_view reason) {
  const std::string pointer = fmt::format("/accessors/{}", accessor);
  return {ErrorCode::invalid_mesh, fmt::format("The glTF is invalid at {}: {}", pointer, reason),
          pointer};
}

/// Where the elements of an accessor, or of a part of a sparse one, stand.
Result<StridedElements> elements(const GltfTables& tables, std::size_t view, std::uint64_t offset,
                                 std::size_t size) {
  const auto bytes = view_bytes(tables, view);
  if (!bytes) return bytes.error();
  return StridedElements{bytes->data() + offset,
                         static_cast<std::size_t>(tables.views[view].stride.value_or(size)), 1, 1};
}

/// Overwrites the elements that a sparse accessor lists.
template <class T>
Result<void> apply_sparse(const GltfTables& tables, std::size_t index, std::span<T> out) {
  const GltfAccessor& accessor = tables.accessors[index];
  const GltfSparse& sparse = *accessor.sparse;
  auto indices =
      elements(tables, sparse.indices_view, sparse.indices_offset, size_of(sparse.indices_type));
  if (!indices) return indices.error();
  auto values = elements(tables, sparse.values_view, sparse.values_offset, accessor.element_size);
  if (!values) return values.error();
  const auto components = static_cast<std::size_t>(accessor.components);
  values->components = components;
  for (std::uint64_t i = 0; i < sparse.count; ++i) {
    std::uint32_t at = 0;
    read_components(sparse.indices_type, *indices, &at);
    if (at >= accessor.count) return accessor_error(index, "a sparse index is out of range.");
    read_components(accessor.type, *values, out.data() + at * components);
    indices->first += indices->stride;
    values->first += values->stride;
  }
  return {};
}

/// The number of all components, if it may be believed.
Result<std::size_t> number_count(const GltfTables& tables, std::size_t index) {
  const GltfAccessor& accessor = tables.accessors[index];
  // An accessor without a view costs no bytes, so its count proves nothing.
  if (!accessor.view && accessor.count > tables.element_limit) {
    return accessor_error(index, "more elements are stated than the size of the file allows.");
  }
  return static_cast<std::size_t>(accessor.count) * static_cast<std::size_t>(accessor.components);
}

/// All components into `out`, which has room for them and holds zeros where there is no view.
template <class T>
Result<void> read_into(const GltfTables& tables, std::size_t index, std::span<T> out) {
  const GltfAccessor& accessor = tables.accessors[index];
  if (accessor.view) {
    auto from = elements(tables, *accessor.view, accessor.offset, accessor.element_size);
    if (!from) return from.error();
    from->count = static_cast<std::size_t>(accessor.count);
    from->components = static_cast<std::size_t>(accessor.components);
    read_components(accessor.type, *from, out.data());
  }
  return accessor.sparse ? apply_sparse(tables, index, out) : Result<void>();
}

/// An accessor with a view, read by and by: what is done to a block right after it was read finds
/// it in the cache.
class Blocks {
 public:
  static Result<Blocks> open(const GltfTables& tables, const GltfAccessor& accessor) {
    auto from = elements(tables, *accessor.view, accessor.offset, accessor.element_size);
    if (!from) return from.error();
    from->components = static_cast<std::size_t>(accessor.components);
    return Blocks(accessor, *from);
  }

  bool done() const { return next_ == count_; }
  /// Numbers read once the next block is.
  std::size_t end_of_next() const { return (next_ + block_size()) * from_.components; }

  /// Reads the next block to its place in `all`, which this returns.
  template <class T>
  std::span<T> read_next(std::span<T> all) {
    from_.count = block_size();
    const auto out = all.subspan(next_ * from_.components, from_.count * from_.components);
    read_components(type_, from_, out.data());
    from_.first += from_.count * from_.stride;
    next_ += from_.count;
    return out;
  }

 private:
  /// A multiple of three: blocks of indices are whole triangles.
  static constexpr std::size_t kElements = 1536;

  Blocks(const GltfAccessor& accessor, const StridedElements& from)
      : type_(accessor.type), count_(static_cast<std::size_t>(accessor.count)), from_(from) {}

  std::size_t block_size() const { return std::min(kElements, count_ - next_); }

  ComponentType type_;
  std::size_t count_;
  std::size_t next_ = 0;
  StridedElements from_;
};

template <class T>
Result<std::vector<T>> read_all(const GltfTables& tables, std::size_t index) {
  const auto count = number_count(tables, index);
  if (!count) return count.error();
  std::vector<T> out(*count);
  if (const auto done = read_into<T>(tables, index, out); !done) return done.error();
  return out;
}

void decode_normalized(const GltfAccessor& accessor, std::span<double> values) {
  if (!accessor.normalized) return;
  for (double& value : values) value = decode_component({accessor.type, true}, value);
}

Result<void> check_indices(const GltfAccessor& accessor, std::size_t index) {
  const bool is_unsigned = accessor.type == ComponentType::u8 ||
                           accessor.type == ComponentType::u16 ||
                           accessor.type == ComponentType::u32;
  if (accessor.is_scalar() && is_unsigned && !accessor.normalized) return {};
  return accessor_error(index, "indices are scalars of an unsigned integer type.");
}

}  // namespace

Result<std::vector<double>> read_stored(const GltfTables& tables, std::size_t index) {
  return read_all<double>(tables, index);
}

Result<std::vector<double>> read_values(const GltfTables& tables, std::size_t index) {
  auto out = read_stored(tables, index);
  if (out) decode_normalized(tables.accessors[index], *out);
  return out;
}

Result<bool> append_vectors(const GltfTables& tables, std::size_t index, std::vector<Vec3>& out) {
  const GltfAccessor& accessor = tables.accessors[index];
  const auto count = number_count(tables, index);
  if (!count) return count.error();
  const std::size_t before = out.size();
  if (accessor.view) {
    out.resize(before + *count / 3);
  } else {
    out.resize(before + *count / 3, Vec3::Zero());
  }
  const std::span<double> numbers(out.data()->data() + 3 * before, *count);
  bool finite = true;
  const auto finish = [&](std::span<double> read) {
    decode_normalized(accessor, read);
    finite &= all_finite(read);
  };
  if (accessor.view && !accessor.sparse) {
    auto blocks = Blocks::open(tables, accessor);
    if (!blocks) return blocks.error();
    while (!blocks->done()) finish(blocks->read_next(numbers));
    return finite;
  }
  if (auto done = read_into(tables, index, numbers); !done) return done.error();
  finish(numbers);
  return finite;
}

Result<std::vector<Index>> read_indices(const GltfTables& tables, std::size_t index) {
  if (auto done = check_indices(tables.accessors[index], index); !done) return done.error();
  return read_all<Index>(tables, index);
}

Result<std::vector<Triangle>> read_index_triples(const GltfTables& tables, std::size_t index) {
  if (auto done = check_indices(tables.accessors[index], index); !done) return done.error();
  const auto count = number_count(tables, index);
  if (!count) return count.error();
  const GltfAccessor& accessor = tables.accessors[index];
  std::vector<Triangle> out;
  if (accessor.view && !accessor.sparse) {
    auto blocks = Blocks::open(tables, accessor);
    if (!blocks) return blocks.error();
    out.reserve(*count / 3);
    while (!blocks->done()) {
      // Grows with the blocks, so that its zeros are still in the cache when they are written over.
      out.resize(std::min(*count, blocks->end_of_next()) / 3);
      blocks->read_next(std::span<Index>(out.data()->data(), 3 * out.size()));
    }
    return out;
  }
  out.resize(*count / 3);
  const std::span<Index> numbers(out.data()->data(), *count);
  if (auto done = read_into(tables, index, numbers); !done) return done.error();
  return out;
}

}  // namespace fairway
