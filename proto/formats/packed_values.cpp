// Values on their way into a buffer. Source: glTF 2.0 section 3.6.2.4 (alignment), 3.6.2.5
// (bounds).

#include "proto/formats/packed_values.h"

#include <algorithm>
#include <array>
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

/// The least and greatest numbers of elements of one to four floats that come by and by.
class FloatBounds {
 public:
  /// Twelve numbers at a time are whole elements and whole registers.
  static constexpr std::size_t kPeriod = 12;

  FloatBounds() {
    least_.fill(std::numeric_limits<float>::infinity());
    most_.fill(-std::numeric_limits<float>::infinity());
  }

  /// All but the last of several times by a multiple of kPeriod.
  void look(std::span<const float> values) {
    std::size_t i = 0;
    for (; i + kPeriod <= values.size(); i += kPeriod) {
      for (std::size_t phase = 0; phase < kPeriod; ++phase) look(values[i + phase], phase);
    }
    for (std::size_t phase = 0; i < values.size(); ++phase, ++i) look(values[i], phase);
  }

  void put(PackedValues& out) const {
    const auto components = static_cast<std::size_t>(out.components);
    out.min.assign(least_.begin(), least_.begin() + out.components);
    out.max.assign(most_.begin(), most_.begin() + out.components);
    for (std::size_t phase = components; phase < kPeriod; ++phase) {
      double& low = out.min[phase % components];
      double& high = out.max[phase % components];
      low = std::min(low, static_cast<double>(least_[phase]));
      high = std::max(high, static_cast<double>(most_[phase]));
    }
  }

 private:
  void look(float v, std::size_t phase) {
    least_[phase] = v < least_[phase] ? v : least_[phase];
    most_[phase] = v > most_[phase] ? v : most_[phase];
  }

  std::array<float, kPeriod> least_;
  std::array<float, kPeriod> most_;
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

PackedValues borrow_floats(std::span<const float> values, int components) {
  PackedValues out;
  out.components = components;
  out.count = values.size() / static_cast<std::size_t>(components);
  out.stride = sizeof(float) * static_cast<std::size_t>(components);
  out.borrowed = std::as_bytes(values);
  return out;
}

PackedValues pack_floats(std::span<const float> values, int components) {
  PackedValues out = borrow_floats(values, components);
  out.bytes.assign(out.borrowed.begin(), out.borrowed.end());
  out.borrowed = {};
  FloatBounds bounds;
  bounds.look(values);
  bounds.put(out);
  return out;
}

PackedValues pack_vectors(std::span<const Vec3> vectors) {
  constexpr std::size_t kBlock = 128 * FloatBounds::kPeriod;
  PackedValues out;
  out.components = 3;
  out.count = vectors.size();
  out.stride = 3 * sizeof(float);
  // Grows by blocks, so that each is in the cache until it is done with.
  out.bytes.reserve(vectors.size() * out.stride);
  FloatBounds bounds;
  for (std::size_t first = 0; first < vectors.size(); first += kBlock) {
    const auto block = vectors.subspan(first, std::min(kBlock, vectors.size() - first));
    out.bytes.resize((first + block.size()) * out.stride);
    float* const begin = reinterpret_cast<float*>(out.bytes.data() + first * out.stride);
    float* to = begin;
    for (const Vec3& vector : block) {
      for (int c = 0; c < 3; ++c) *to++ = static_cast<float>(vector[c]);
    }
    bounds.look({begin, 3 * block.size()});
  }
  bounds.put(out);
  return out;
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
