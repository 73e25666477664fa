// New PLY, OBJ and STL files.

#include "proto/formats/fresh_shape.h"

#include <array>
#include <cctype>
#include <limits>

#include <fmt/format.h>

#include "proto/formats/bytes.h"
#include "proto/formats/ply_surface.h"
#include "proto/formats/polygons.h"
#include "proto/formats/stl_triangles.h"
#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

std::vector<std::byte> bytes_of(std::string_view text) {
  const ByteSpan bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}

std::string ply_header(const FreshParts& parts, bool floats, bool signed_indices) {
  std::string out =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment fairway\nelement vertex {}\n",
                  parts.positions.size());
  for (const char* name : {"x", "y", "z"}) {
    out += fmt::format("property {} {}\n", floats ? "float" : "double", name);
  }
  if (!parts.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  for (const VertexAttribute& attribute : parts.attributes) {
    for (const std::string& name : property_names(attribute)) {
      out += fmt::format("property float {}\n", name);
    }
  }
  if (!parts.extras.texture_coordinates.empty()) out += "property float s\nproperty float t\n";
  for (std::size_t c = 0; c < static_cast<std::size_t>(parts.extras.colors.components); ++c) {
    out += fmt::format("property uchar {}\n", kPlyColors[c]);
  }
  out += fmt::format("element face {}\nproperty list uchar {} vertex_indices\nend_header\n",
                     parts.triangles.size(), signed_indices ? "int" : "uint");
  return out;
}

void append_floats(const Vec3& vector, std::vector<std::byte>& out) {
  for (int c = 0; c < 3; ++c) append_value(out, static_cast<float>(vector[c]));
}

/// The elements of one vertex in a list with so many of each.
template <class T>
std::span<const T> of_vertex(const std::vector<T>& values, std::size_t vertex, int components) {
  const auto size = static_cast<std::size_t>(components);
  return std::span(values).subspan(vertex * size, size);
}

void append_ply_vertex(const FreshParts& parts, std::size_t v, bool floats,
                       std::vector<std::byte>& out) {
  if (floats) {
    append_floats(parts.positions[v], out);
  } else {
    for (int c = 0; c < 3; ++c) append_value(out, parts.positions[v][c]);
  }
  if (!parts.normals.empty()) append_floats(parts.normals[v], out);
  for (const VertexAttribute& attribute : parts.attributes) {
    append(out, std::as_bytes(of_vertex(attribute.values, v, attribute.components)));
  }
  const VertexExtras& extras = parts.extras;
  if (!extras.texture_coordinates.empty()) {
    append(out, std::as_bytes(of_vertex(extras.texture_coordinates, v, 2)));
  }
  if (extras.colors.empty()) return;
  for (const float value : of_vertex(extras.colors.values, v, extras.colors.components)) {
    append_value(out, color_byte(value));
  }
}

std::vector<std::byte> write_ply(const FreshParts& parts) {
  const bool floats = fit_floats(parts.positions);
  const bool small = parts.positions.size() <= std::numeric_limits<std::int32_t>::max();
  std::vector<std::byte> out = bytes_of(ply_header(parts, floats, small));
  out.reserve(out.size() + parts.positions.size() * 64 + parts.triangles.size() * 13);
  for (std::size_t v = 0; v < parts.positions.size(); ++v) {
    append_ply_vertex(parts, v, floats, out);
  }
  for (const Triangle& triangle : parts.triangles) {
    append_value(out, std::uint8_t{3});
    append_value(out, triangle);
  }
  return out;
}

template <class T>
void append_word(T value, std::string& out) {
  out += ' ';
  out += shortest(value);
}

void append_words(const Vec3& vector, bool floats, std::string& out) {
  for (int c = 0; c < 3; ++c) {
    if (floats) {
      append_word(static_cast<float>(vector[c]), out);
    } else {
      append_word(vector[c], out);
    }
  }
}

void append_obj_vertices(const FreshParts& parts, std::string& out) {
  const bool floats = fit_floats(parts.positions);
  const auto& [colors, texture_coordinates] = parts.extras;
  for (std::size_t v = 0; v < parts.positions.size(); ++v) {
    out += 'v';
    append_words(parts.positions[v], floats, out);
    if (!colors.empty()) {
      const auto color = of_vertex(colors.values, v, colors.components);
      for (const float value : color.first(3)) append_word(value, out);
    }
    out += '\n';
  }
  for (std::size_t i = 0; i < texture_coordinates.size(); i += 2) {
    out += "vt";
    append_word(texture_coordinates[i], out);
    append_word(texture_coordinates[i + 1], out);
    out += '\n';
  }
  for (const Vec3& normal : parts.normals) {
    out += "vn";
    append_words(normal, true, out);
    out += '\n';
  }
}

std::vector<std::byte> write_obj(const FreshParts& parts) {
  std::string out = "# fairway\n";
  append_obj_vertices(parts, out);
  const bool textured = !parts.extras.texture_coordinates.empty();
  const bool normals = !parts.normals.empty();
  for (const Triangle& triangle : parts.triangles) {
    out += 'f';
    for (const Index vertex : triangle) {
      // v, v/vt, v//vn or v/vt/vn, all with the same number.
      const fmt::format_int number(std::size_t{vertex} + 1);
      const std::string_view word(number.data(), number.size());
      (out += ' ') += word;
      if (textured || normals) out += '/';
      if (textured) out += word;
      if (normals) (out += '/') += word;
    }
    out += '\n';
  }
  return bytes_of(out);
}

std::vector<std::byte> write_stl(const FreshParts& parts) {
  std::array<std::byte, kStlHeaderBytes> header{};
  const ByteSpan name = as_bytes("fairway");
  std::copy(name.begin(), name.end(), header.begin());
  std::vector<std::byte> out(header.begin(), header.end());
  append_value(out, static_cast<std::uint32_t>(parts.triangles.size()));
  out.reserve(out.size() + parts.triangles.size() * kStlTriangleBytes);
  for (const auto& [a, b, c] : parts.triangles) {
    append_stl_triangle(parts.positions[a], parts.positions[b], parts.positions[c], 0, out);
  }
  return out;
}

}  // namespace

std::vector<std::string> property_names(const VertexAttribute& attribute) {
  std::string base = attribute.name;
  if (!base.empty() && base.front() == '_') base.erase(0, 1);
  for (char& c : base) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (attribute.components == 1) return {base};
  constexpr std::array<char, 4> kAxes = {'x', 'y', 'z', 'w'};
  std::vector<std::string> out;
  for (std::size_t c = 0; c < static_cast<std::size_t>(attribute.components); ++c) {
    out.push_back(fmt::format("{}_{}", base, kAxes[c]));
  }
  return out;
}

std::vector<std::byte> write_fresh_shape(const FreshParts& parts, Format format) {
  if (format == Format::ply) return write_ply(parts);
  if (format == Format::obj) return write_obj(parts);
  return write_stl(parts);
}

}  // namespace fairway
