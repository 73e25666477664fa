// New PLY, OBJ and STL files, and which document is written how.

#include "proto/formats/fresh_mesh.h"

#include <array>
#include <cctype>
#include <limits>

#include <fmt/format.h>

#include "proto/formats/bytes.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_compression.h"
#include "proto/formats/polygons.h"
#include "proto/formats/stl_triangles.h"
#include "proto/formats/surface_result.h"
#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

/// What is written, wherever it stands.
struct Parts {
  const std::vector<Vec3>& positions;
  const std::vector<Triangle>& triangles;
  const std::vector<Vec3>& normals;
  const std::vector<VertexAttribute>& attributes;
  const std::optional<VertexColors>& colors;
};

std::vector<std::byte> bytes_of(std::string_view text) {
  const ByteSpan bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}

bool is_shape(Format format) {
  return format == Format::ply || format == Format::obj || format == Format::stl;
}

/// Without a scene around it.
bool holds_one_mesh(Format format) {
  return is_shape(format) || format == Format::drc;
}

std::string ply_header(const Parts& parts, bool floats, bool signed_indices) {
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
  if (parts.colors) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  out += fmt::format("element face {}\nproperty list uchar {} vertex_indices\nend_header\n",
                     parts.triangles.size(), signed_indices ? "int" : "uint");
  return out;
}

void append_floats(const Vec3& vector, std::vector<std::byte>& out) {
  for (int c = 0; c < 3; ++c) append_value(out, static_cast<float>(vector[c]));
}

std::vector<std::byte> write_ply(const Parts& parts) {
  const bool floats = fit_floats(parts.positions);
  const bool small = parts.positions.size() <= std::numeric_limits<std::int32_t>::max();
  std::vector<std::byte> out = bytes_of(ply_header(parts, floats, small));
  out.reserve(out.size() + parts.positions.size() * 64 + parts.triangles.size() * 13);
  for (std::size_t v = 0; v < parts.positions.size(); ++v) {
    if (floats) {
      append_floats(parts.positions[v], out);
    } else {
      for (int c = 0; c < 3; ++c) append_value(out, parts.positions[v][c]);
    }
    if (!parts.normals.empty()) append_floats(parts.normals[v], out);
    for (const VertexAttribute& attribute : parts.attributes) {
      const auto components = static_cast<std::size_t>(attribute.components);
      for (std::size_t c = 0; c < components; ++c) {
        append_value(out, attribute.values[v * components + c]);
      }
    }
    if (parts.colors) append_value(out, parts.colors->values[v]);
  }
  for (const Triangle& triangle : parts.triangles) {
    append_value(out, std::uint8_t{3});
    append_value(out, triangle);
  }
  return out;
}

void append_obj_line(std::string_view key, const Vec3& vector, bool floats, std::string& out) {
  out += key;
  for (int c = 0; c < 3; ++c) {
    out += ' ';
    out += floats ? shortest(static_cast<float>(vector[c])) : shortest(vector[c]);
  }
  out += '\n';
}

std::vector<std::byte> write_obj(const Parts& parts) {
  const bool floats = fit_floats(parts.positions);
  std::string out = "# fairway\n";
  for (const Vec3& position : parts.positions) append_obj_line("v", position, floats, out);
  for (const Vec3& normal : parts.normals) append_obj_line("vn", normal, true, out);
  for (const auto& [a, b, c] : parts.triangles) {
    const std::size_t i = std::size_t{a} + 1;
    const std::size_t j = std::size_t{b} + 1;
    const std::size_t k = std::size_t{c} + 1;
    out += parts.normals.empty() ? fmt::format("f {} {} {}\n", i, j, k)
                                 : fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", i, j, k);
  }
  return bytes_of(out);
}

Result<std::vector<std::byte>> write_stl(const Parts& parts) {
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

Result<Encoded> write_gltf(const Parts& parts, Format format, const Encoding& encoding,
                           std::string_view name) {
  FreshMesh mesh;
  mesh.triangles = parts.triangles;
  mesh.attributes.push_back({"POSITION", pack_vectors(parts.positions)});
  if (!parts.normals.empty()) mesh.attributes.push_back({"NORMAL", pack_vectors(parts.normals)});
  for (const VertexAttribute& attribute : parts.attributes) {
    mesh.attributes.push_back(
        {attribute.name, pack_floats(attribute.values, attribute.components)});
  }
  if (parts.colors) {
    mesh.attributes.push_back({"COLOR_0", pack_linear_colors(parts.colors->values)});
  }
  return write_fresh_gltf(mesh, format, encoding, name);
}

std::string_view upper_name(Format format) {
  if (format == Format::drc) return "Draco";
  if (format == Format::ply) return "PLY";
  if (format == Format::obj) return "OBJ";
  return "STL";
}

Result<std::vector<std::byte>> write_shape(const Parts& parts, Format format) {
  if (format == Format::ply) return write_ply(parts);
  if (format == Format::obj) return write_obj(parts);
  return write_stl(parts);
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

Result<Encoded> write_fresh_mesh(const Surface& surface, const SurfaceResult& result, Format format,
                                 const Encoding& encoding) {
  const Parts parts{result.moved ? result.positions : surface.mesh.positions,
                    surface.mesh.triangles, result.moved ? result.normals : surface.normals,
                    result.attributes, result.colors};
  for (const Vec3& position : parts.positions) {
    if (!position.cast<float>().allFinite()) {
      if (!result.moved) {
        return Error{ErrorCode::invalid_mesh,
                     "A position is beyond single precision; scale the mesh down first."};
      }
      return Error{ErrorCode::diverged,
                   "A position left the range of single precision; use fewer or smaller steps."};
    }
  }
  if (format == Format::drc) return write_fresh_draco(surface, result, encoding.draco);
  if (!is_shape(format)) return write_gltf(parts, format, encoding, surface.name);
  auto bytes = write_shape(parts, format);
  if (!bytes) return bytes.error();
  return Encoded{ByteChain(*std::move(bytes)), {}};
}

Result<Encoded> convert(const Document& document, std::span<const SurfaceResult> results,
                        const Conversion& conversion) {
  const auto& [came, wanted, encoding] = conversion;
  if (wanted == came || !holds_one_mesh(wanted) || is_shape(came)) {
    return document.write(results, wanted, encoding);
  }
  const auto done = check_results(document.surfaces(), results);
  if (!done) return done.error();
  if (results.size() != 1) {
    return Error{ErrorCode::unsupported_feature,
                 fmt::format("The file has {} meshes and {} holds one without a scene around it; "
                             "ask for glb or gltf.",
                             results.size(), upper_name(wanted)),
                 "/meshes"};
  }
  return write_fresh_mesh(document.surfaces().front(), results.front(), wanted, encoding);
}

Result<std::vector<std::byte>> convert(const Document& document,
                                       std::span<const SurfaceResult> results, Format came,
                                       Format wanted) {
  auto out = convert(document, results, Conversion{came, wanted});
  if (!out) return out.error();
  return out->bytes.joined();
}

std::vector<std::string> conversion_notes(const Document& document,
                                          std::span<const SurfaceResult> results, Format came,
                                          Format wanted) {
  std::vector<std::string> out;
  bool has_attributes = false;
  for (const SurfaceResult& result : results) {
    has_attributes |= !result.attributes.empty() || result.colors;
  }
  if (has_attributes && (wanted == Format::obj || wanted == Format::stl)) {
    out.push_back(
        fmt::format("{} has no place for attributes of vertices: the curvature is not stored; ask "
                    "for ply or glb to get it",
                    upper_name(wanted)));
  }
  if (came == wanted || !(is_shape(came) || holds_one_mesh(wanted))) return out;
  std::vector<std::string> lost = document.facts().left_behind;
  const std::vector<Surface>& surfaces = document.surfaces();
  if (wanted == Format::stl && !surfaces.empty() && !surfaces.front().normals.empty()) {
    lost.emplace_back("normals of vertices");
  }
  if (lost.empty()) return out;
  out.push_back(
      fmt::format("written anew as {}, without {}", name_of(wanted), fmt::join(lost, ", ")));
  return out;
}

std::vector<std::string> kept_color_notes(std::span<const Surface> surfaces,
                                          std::span<const SurfaceResult> results,
                                          const Conversion& conversion) {
  const bool scene = !holds_one_mesh(conversion.wanted);
  const bool carried =
      conversion.came == conversion.wanted || (scene && (!is_shape(conversion.came)));
  std::size_t kept = 0;
  std::string first;
  for (std::size_t i = 0; carried && i < surfaces.size(); ++i) {
    for (const PrimitiveVertices& primitive : surfaces[i].primitives) {
      if (!results[i].colors || results[i].colors_vertices(primitive.has_colors)) continue;
      if (kept++ == 0) first = surfaces[i].name;
    }
  }
  if (kept == 0) return {};
  return {fmt::format(
      "{} keep{} the colours that the file has (the first in {}); \"colors\": {{\"replace\": "
      "true}} "
      "replaces them",
      kept == 1 ? "1 primitive" : fmt::format("{} primitives", kept), kept == 1 ? "s" : "", first)};
}

}  // namespace fairway
