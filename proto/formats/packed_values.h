#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "proto/formats/bytes.h"
#include "proto/formats/component_type.h"

namespace fairway {

/// The elements of one accessor as they will be stored.
struct PackedValues {
  ComponentType type = ComponentType::f32;
  bool normalized = false;
  int components = 1;
  std::uint64_t count = 0;
  std::size_t stride = 0;  ///< bytes between elements
  std::vector<std::byte> bytes;
  ByteSpan borrowed = {};        ///< bytes that somebody else keeps, instead of `bytes`
  std::vector<double> min, max;  ///< of the stored values, per component; none if borrowed

  ByteSpan stored() const { return borrowed.empty() ? ByteSpan(bytes) : borrowed; }
  bool is_tight() const { return stride == size_of(type) * static_cast<std::size_t>(components); }
};

/// Whether an accessor states the least and greatest values of its elements.
enum class Bounds { left_out, stated };

/// How pack_values() stores a vertex attribute.
struct Packing {
  ComponentType type = ComponentType::f32;
  bool normalized = false;  ///< only stated, the values are stored ones already
  int components = 1;
};

/// Vertex attributes: elements start at multiples of four. `values` are stored values that fit the
/// type, see encode_component().
PackedValues pack_values(std::span<const double> values, const Packing& packing);
PackedValues pack_floats(std::span<const float> values, int components);
/// The same without bounds, as they stand in `values`, which must outlive what is packed.
PackedValues borrow_floats(std::span<const float> values, int components);
PackedValues pack_vectors(std::span<const Vec3> vectors);

/// Triangle indices, tight, in the smallest of `least`, u16 and u32 that holds vertices of
/// `vertex_count` (the highest value of a type is kept free: it restarts primitives).
PackedValues pack_triangles(std::span<const Triangle> triangles, Index vertex_count,
                            ComponentType least);

}  // namespace fairway
