#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "proto/formats/bytes.h"

namespace fairway {

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Bytes of a value in a binary file.
std::size_t size_of(PlyType type);
bool is_real(PlyType type);

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;            ///< of the value, or of each in a list
  std::optional<PlyType> list_size = {};  ///< type of a list's count; nothing for scalars
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< as claimed, not yet believed
  std::vector<PlyProperty> properties;

  /// Index of the property, nothing where there is none.
  std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;        ///< bytes, the end of the last line included
  std::size_t vertex_end = 0;  ///< offset behind the lines of the element "vertex"
  std::string_view line_end = "\n";

  const PlyElement* find(std::string_view element) const;
};

/// Reads the header of a PLY 1.0. Errors: malformed_input, unsupported_format (another version),
/// invalid_mesh (a name twice, a negative count, properties without end).
Result<PlyHeader> read_ply_header(ByteSpan bytes);

}  // namespace fairway
