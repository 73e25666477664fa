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

void find_bounds(std::span<const float> values, PackedValues& out) {
  // Twelve numbers at a time are whole elements of one to four components, and whole registers.
  constexpr std::size_t kPeriod = 12;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, kPeriod> least;
  std::array<float, kPeriod> most;
  least.fill(kInfinity);
  most.fill(-kInfinity);
  const auto look = [&](std::size_t i, std::size_t phase) {
    const float v = values[i];
    least[phase] = v < least[phase] ? v : least[phase];
    most[phase] = v > most[phase] ? v : most[phase];
  };
  std::size_t i = 0;
  for (; i + kPeriod <= values.size(); i += kPeriod) {
    for (std::size_t phase = 0; phase < kPeriod; ++phase) look(i + phase, phase);
  }
  for (std::size_t phase = 0; i < values.size(); ++phase, ++i) look(i, phase);
  const auto components = static_cast<std::size_t>(out.components);
  out.min.assign(least.begin(), least.begin() + out.components);
  out.max.assign(most.begin(), most.begin() + out.components);
  for (std::size_t phase = components; phase < kPeriod; ++phase) {
    double& low = out.min[phase % components];
    double& high = out.max[phase % components];
    low = std::min(low, static_cast<double>(least[phase]));
    high = std::max(high, static_cast<double>(most[phase]));
  }
}

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
  find_bounds(values, out);
  return out;
}

PackedValues pack_vectors(std::span<const Vec3> vectors) {
  PackedValues out;
  out.components = 3;
  out.count = vectors.size();
  out.stride = 3 * sizeof(float);
  out.bytes.resize(vectors.size() * out.stride);
  float* to = reinterpret_cast<float*>(out.bytes.data());
  for (const Vec3& vector : vectors) {
    for (int c = 0; c < 3; ++c) *to++ = static_cast<float>(vector[c]);
  }
  find_bounds({reinterpret_cast<const float*>(out.bytes.data()), 3 * vectors.size()}, out);
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
