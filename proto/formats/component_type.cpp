// Component types of glTF accessors. Source: glTF 2.0 sections 3.6.2 and 3.11.

#include "proto/formats/component_type.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "proto/formats/bytes.h"

namespace fairway {
namespace {

struct Limits {
  double low, high;
};

template <class T>
constexpr Limits limits_of() {
  return {static_cast<double>(std::numeric_limits<T>::lowest()),
          static_cast<double>(std::numeric_limits<T>::max())};
}

Limits limits_of(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
      return limits_of<std::int8_t>();
    case ComponentType::u8:
      return limits_of<std::uint8_t>();
    case ComponentType::i16:
      return limits_of<std::int16_t>();
    case ComponentType::u16:
      return limits_of<std::uint16_t>();
    case ComponentType::u32:
      return limits_of<std::uint32_t>();
    case ComponentType::f32:
      break;
  }
  return limits_of<float>();
}

template <class Stored, class T>
void read_all(const StridedElements& elements, T* out) {
  // Without gaps it is one loop, which the compiler turns into wide loads.
  if (elements.stride == elements.components * sizeof(Stored)) {
    for (std::size_t i = 0; i < elements.count * elements.components; ++i) {
      out[i] = static_cast<T>(load<Stored>(elements.first + i * sizeof(Stored)));
    }
    return;
  }
  for (std::size_t i = 0; i < elements.count; ++i) {
    const std::byte* from = elements.first + i * elements.stride;
    for (std::size_t c = 0; c < elements.components; ++c) {
      *out++ = static_cast<T>(load<Stored>(from + c * sizeof(Stored)));
    }
  }
}

}  // namespace

std::optional<ComponentType> component_type_of(std::uint64_t number) {
  if (number < 5120 || number > 5126 || number == 5124) return std::nullopt;
  return static_cast<ComponentType>(number);
}

std::size_t size_of(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
    case ComponentType::u8:
      return 1;
    case ComponentType::i16:
    case ComponentType::u16:
      return 2;
    case ComponentType::u32:
    case ComponentType::f32:
      break;
  }
  return 4;
}

int components_of_type_name(std::string_view name) {
  struct Row {
    std::string_view name;
    int components;
  };
  constexpr std::array<Row, 7> kRows = {{{"SCALAR", 1},
                                         {"VEC2", 2},
                                         {"VEC3", 3},
                                         {"VEC4", 4},
                                         {"MAT2", 4},
                                         {"MAT3", 9},
                                         {"MAT4", 16}}};
  const auto* row = std::find_if(kRows.begin(), kRows.end(),
                                 [name](const Row& candidate) { return candidate.name == name; });
  return row == kRows.end() ? 0 : row->components;
}

std::string_view vector_type_name(int components) {
  constexpr std::array<std::string_view, 4> kNames = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kNames[static_cast<std::size_t>(components - 1)];
}

std::size_t element_size(ComponentType type, std::string_view type_name) {
  const std::size_t component = size_of(type);
  const bool small = component < 4;
  if (small && type_name == "MAT2") return component == 1 ? 8 : component * 4;
  if (small && type_name == "MAT3") return component == 1 ? 12 : 24;
  return component * static_cast<std::size_t>(components_of_type_name(type_name));
}

double read_component(ComponentType type, const std::byte* data) {
  switch (type) {
    case ComponentType::i8:
      return load<std::int8_t>(data);
    case ComponentType::u8:
      return load<std::uint8_t>(data);
    case ComponentType::i16:
      return load<std::int16_t>(data);
    case ComponentType::u16:
      return load<std::uint16_t>(data);
    case ComponentType::u32:
      return load<std::uint32_t>(data);
    case ComponentType::f32:
      break;
  }
  return load<float>(data);
}

void read_components(ComponentType type, const StridedElements& elements, double* out) {
  switch (type) {
    case ComponentType::i8:
      return read_all<std::int8_t>(elements, out);
    case ComponentType::u8:
      return read_all<std::uint8_t>(elements, out);
    case ComponentType::i16:
      return read_all<std::int16_t>(elements, out);
    case ComponentType::u16:
      return read_all<std::uint16_t>(elements, out);
    case ComponentType::u32:
      return read_all<std::uint32_t>(elements, out);
    case ComponentType::f32:
      return read_all<float>(elements, out);
  }
}

void read_components(ComponentType type, const StridedElements& elements, std::uint32_t* out) {
  if (type == ComponentType::u8) return read_all<std::uint8_t>(elements, out);
  if (type == ComponentType::u16) return read_all<std::uint16_t>(elements, out);
  return read_all<std::uint32_t>(elements, out);
}

double decode_component(const ComponentEncoding& encoding, double stored) {
  if (!encoding.normalized || encoding.type == ComponentType::f32) return stored;
  return std::max(stored / limits_of(encoding.type).high, -1.0);
}

double encode_component(const ComponentEncoding& encoding, double value) {
  if (encoding.type == ComponentType::f32) return static_cast<double>(static_cast<float>(value));
  const Limits limits = limits_of(encoding.type);
  if (std::isnan(value)) return 0.0;
  return std::clamp(std::round(encoding.normalized ? value * limits.high : value), limits.low,
                    limits.high);
}

void append_component(ComponentType type, double value, std::vector<std::byte>& out) {
  switch (type) {
    case ComponentType::i8:
      return append_value(out, static_cast<std::int8_t>(value));
    case ComponentType::u8:
      return append_value(out, static_cast<std::uint8_t>(value));
    case ComponentType::i16:
      return append_value(out, static_cast<std::int16_t>(value));
    case ComponentType::u16:
      return append_value(out, static_cast<std::uint16_t>(value));
    case ComponentType::u32:
      return append_value(out, static_cast<std::uint32_t>(value));
    case ComponentType::f32:
      return append_value(out, static_cast<float>(value));
  }
}

}  // namespace fairway
