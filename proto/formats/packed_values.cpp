// Values on their way into a buffer. Source: glTF 2.0 section 3.6.2.4 (alignment), 3.6.2.5
// (bounds).

#include "proto/formats/packed_values.h"

#include <algorithm>
#include <limits>

#include "proto/formats/bytes.h"

namespace fairway {
namespace {

enum class Alignment { tight, four };

/// Appends elements one after the other and keeps their bounds.
class Packer {
 public:
  Packer(const Packing& packing, std::size_t count, Alignment alignment) {
    out_.type = packing.type;
    out_.normalized = packing.normalized;
    out_.components = packing.components;
    out_.count = count;
    const auto components = static_cast<std::size_t>(packing.components);
    const std::size_t tight = size_of(packing.type) * components;
    out_.stride = alignment == Alignment::four ? (tight + 3) / 4 * 4 : tight;
    out_.bytes.reserve(count * out_.stride);
    out_.min.assign(components, std::numeric_limits<double>::infinity());
    out_.max.assign(components, -std::numeric_limits<double>::infinity());
  }

  void add(double value) {
    const double stored =
        out_.type == ComponentType::f32 ? static_cast<double>(static_cast<float>(value)) : value;
    append_component(out_.type, stored, out_.bytes);
    out_.min[component_] = std::min(out_.min[component_], stored);
    out_.max[component_] = std::max(out_.max[component_], stored);
    if (++component_ == out_.min.size()) {
      component_ = 0;
      out_.bytes.resize(++elements_ * out_.stride);
    }
  }

  PackedValues take() { return std::move(out_); }

 private:
  PackedValues out_;
  std::size_t component_ = 0;
  std::size_t elements_ = 0;
};

ComponentType index_type(Index vertex_count, ComponentType least) {
  const std::uint64_t highest = vertex_count;
  if (least == ComponentType::u8 && highest <= 0xFF) return ComponentType::u8;
  if (least != ComponentType::u32 && highest <= 0xFFFF) return ComponentType::u16;
  return ComponentType::u32;
}

}  // namespace

PackedValues pack_values(std::span<const double> values, const Packing& packing) {
  Packer packer(packing, values.size() / static_cast<std::size_t>(packing.components),
                Alignment::four);
  for (const double value : values) packer.add(value);
  return packer.take();
}

PackedValues pack_floats(std::span<const float> values, int components) {
  const auto per_element = static_cast<std::size_t>(components);
  PackedValues out;
  out.components = components;
  out.count = values.size() / per_element;
  out.stride = sizeof(float) * per_element;
  const auto bytes = std::as_bytes(values);
  out.bytes.assign(bytes.begin(), bytes.end());
  for (std::size_t c = 0; c < per_element; ++c) {
    float least = std::numeric_limits<float>::infinity();
    float most = -least;
    for (std::size_t i = c; i < values.size(); i += per_element) {
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
    }
    out.min.push_back(static_cast<double>(least));
    out.max.push_back(static_cast<double>(most));
  }
  return out;
}

PackedValues pack_vectors(std::span<const Vec3> vectors) {
  std::vector<float> values;
  values.reserve(3 * vectors.size());
  for (const Vec3& vector : vectors) {
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(vector[c]));
  }
  return pack_floats(values, 3);
}

PackedValues pack_triangles(std::span<const Triangle> triangles, Index vertex_count,
                            ComponentType least) {
  Packer packer({index_type(vertex_count, least), false, 1}, triangles.size() * 3,
                Alignment::tight);
  for (const Triangle& triangle : triangles) {
    for (const Index index : triangle) packer.add(static_cast<double>(index));
  }
  return packer.take();
}

}  // namespace fairway
