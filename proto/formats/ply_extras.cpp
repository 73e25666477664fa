// Colours and texture coordinates of a PLY's vertices. Names: those that MeshLab, Blender and
// three.js write and read.

#include "proto/formats/ply_extras.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "proto/formats/ply_surface.h"
#include "proto/formats/ply_values.h"

namespace fairway {
namespace {

constexpr std::array<std::array<std::string_view, 2>, 3> kTexture = {
    {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}};

/// What stands for 1 in a colour of this type; 0 for types that hold none.
double full_scale(PlyType type) {
  if (type == PlyType::u8) return 255.0;
  if (type == PlyType::u16) return 65535.0;
  return is_real(type) ? 1.0 : 0.0;
}

bool holds_color(const PlyProperty& property) {
  return !property.list_size && full_scale(property.type) > 0.0;
}

bool holds_real(const PlyProperty& property) {
  return !property.list_size && is_real(property.type);
}

/// All of the properties, or none.
template <class Test>
std::vector<std::size_t> find_all(const PlyElement& vertex, std::span<const std::string_view> names,
                                  Test fits) {
  std::vector<std::size_t> out;
  for (const std::string_view name : names) {
    const auto found = vertex.find(name);
    if (!found || !fits(vertex.properties[*found])) return {};
    out.push_back(*found);
  }
  return out;
}

/// The values of some properties, vertex after vertex; 0 where there is no number.
Result<std::vector<double>> walk_columns(const PlyRecords& records,
                                         const std::vector<std::size_t>& columns) {
  const std::vector<PlyProperty>& properties = records.vertex.properties;
  const auto count = static_cast<std::size_t>(records.vertex.count);
  std::vector<double> out(count * columns.size());
  PlyValues values(records.bytes, records.encoding);
  for (std::size_t v = 0; v < count; ++v) {
    if (auto begun = values.begin_record(); !begun) return begun.error();
    for (std::size_t p = 0; p < properties.size(); ++p) {
      const auto at = std::find(columns.begin(), columns.end(), p);
      if (at == columns.end()) {
        if (auto skipped = values.skip(properties[p]); !skipped) return skipped.error();
        continue;
      }
      const auto taken = values.take(properties[p].type);
      if (!taken) return taken.error();
      out[v * columns.size() + static_cast<std::size_t>(at - columns.begin())] =
          values.value(*taken, properties[p].type).value_or(0.0);
    }
  }
  return out;
}

/// Offset of a property in a binary record without lists; nothing where there are some.
std::optional<std::size_t> fixed_offset(const PlyElement& vertex, std::size_t property) {
  std::size_t out = 0;
  for (std::size_t p = 0; p < vertex.properties.size(); ++p) {
    if (vertex.properties[p].list_size) return std::nullopt;
    if (p < property) out += size_of(vertex.properties[p].type);
  }
  return out;
}

/// The same; records of one size are not walked over but jumped.
Result<std::vector<double>> read_columns(const PlyRecords& records,
                                         const std::vector<std::size_t>& columns) {
  const PlyElement& vertex = records.vertex;
  const auto size = fixed_offset(vertex, vertex.properties.size());
  if (records.encoding == PlyEncoding::ascii || !size) return walk_columns(records, columns);
  const auto count = static_cast<std::size_t>(vertex.count);
  const PlyValues values(records.bytes, records.encoding);
  std::vector<double> out(count * columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const PlyType type = vertex.properties[columns[c]].type;
    const std::size_t offset = *fixed_offset(vertex, columns[c]);
    for (std::size_t v = 0; v < count; ++v) {
      const ByteSpan taken = records.bytes.subspan(v * *size + offset, size_of(type));
      out[v * columns.size() + c] = values.value(taken, type).value_or(0.0);
    }
  }
  return out;
}

}  // namespace

ExtraKinds PlyExtras::kinds() const {
  return {static_cast<int>(colors.size()), !texture_coordinates.empty()};
}

PlyExtras find_ply_extras(const PlyElement& vertex) {
  PlyExtras out;
  out.colors = find_all(vertex, std::span(kPlyColors), holds_color);
  if (out.colors.empty()) {
    out.colors = find_all(vertex, std::span(kPlyColors).first<3>(), holds_color);
  }
  for (const auto& names : kTexture) {
    if (out.texture_coordinates.empty()) {
      out.texture_coordinates = find_all(vertex, std::span(names), holds_real);
    }
  }
  return out;
}

Result<ColorValues> read_ply_colors(const PlyRecords& records, const PlyExtras& extras) {
  auto values = read_columns(records, extras.colors);
  if (!values) return values.error();
  for (std::size_t i = 0; i < values->size(); ++i) {
    const std::size_t property = extras.colors[i % extras.colors.size()];
    (*values)[i] /= full_scale(records.vertex.properties[property].type);
  }
  return make_colors(*values, static_cast<int>(extras.colors.size()));
}

Result<std::vector<float>> read_ply_texture_coordinates(const PlyRecords& records,
                                                        const PlyExtras& extras) {
  const auto values = read_columns(records, extras.texture_coordinates);
  if (!values) return values.error();
  return make_texture_coordinates(*values);
}

}  // namespace fairway
