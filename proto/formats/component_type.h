#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace fairway {

/// The component types of glTF, with their numbers.
enum class ComponentType : std::uint16_t {
  i8 = 5120,
  u8 = 5121,
  i16 = 5122,
  u16 = 5123,
  u32 = 5125,
  f32 = 5126,
};

/// The type of a glTF number, if there is one.
std::optional<ComponentType> component_type_of(std::uint64_t number);

/// Bytes of one component.
std::size_t size_of(ComponentType type);

/// Components of "SCALAR", "VEC3", "MAT4" …; 0 for any other text.
int components_of_type_name(std::string_view name);

/// "SCALAR" or "VEC2" … "VEC4" for 1 … 4 components.
std::string_view vector_type_name(int components);

/// Bytes of one element. Columns of small matrices start at multiples of four.
std::size_t element_size(ComponentType type, std::string_view type_name);

/// The component at `data` as it is stored; exact.
double read_component(ComponentType type, const std::byte* data);

/// Elements in a buffer.
struct StridedElements {
  const std::byte* first;
  std::size_t stride;  ///< bytes from one to the next
  std::size_t count;
  std::size_t components;  ///< of each, without gaps
};

/// All components of the elements, one after the other, as they are stored; exact.
void read_components(ComponentType type, const StridedElements& elements, double* out);
/// The same of an unsigned integer type.
void read_components(ComponentType type, const StridedElements& elements, std::uint32_t* out);

/// How numbers become components.
struct ComponentEncoding {
  ComponentType type = ComponentType::f32;
  bool normalized = false;  ///< integers stand for [-1, 1] or [0, 1]
};

/// A stored component as the value it stands for.
double decode_component(const ComponentEncoding& encoding, double stored);

/// The inverse of decode_component(): rounded and clamped to what the type holds.
double encode_component(const ComponentEncoding& encoding, double value);

/// Stores `value` as the type has it (a value that encode_component() made).
void append_component(ComponentType type, double value, std::vector<std::byte>& out);

}  // namespace fairway
