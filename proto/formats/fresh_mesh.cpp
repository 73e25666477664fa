// New files around one surface, and which document is written how.

#include "proto/formats/fresh_mesh.h"

#include <fmt/format.h>

#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_compression.h"
#include "proto/formats/fresh_shape.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

bool is_shape(Format format) {
  return format == Format::ply || format == Format::obj || format == Format::stl;
}

/// Without a scene around it.
bool holds_one_mesh(Format format) {
  return is_shape(format) || format == Format::drc;
}

Result<Encoded> write_gltf(const FreshParts& parts, Format format, const Encoding& encoding,
                           std::string_view name) {
  FreshMesh mesh;
  mesh.triangles = parts.triangles;
  mesh.attributes.push_back({"POSITION", pack_vectors(parts.positions)});
  if (!parts.normals.empty()) mesh.attributes.push_back({"NORMAL", pack_vectors(parts.normals)});
  for (const VertexAttribute& attribute : parts.attributes) {
    mesh.attributes.push_back(
        {attribute.name, pack_floats(attribute.values, attribute.components)});
  }
  const auto& [colors, texture_coordinates] = parts.extras;
  if (!texture_coordinates.empty()) {
    mesh.attributes.push_back(
        {"TEXCOORD_0", pack_texture_coordinates_from_top(texture_coordinates)});
  }
  if (!colors.empty()) mesh.attributes.push_back({"COLOR_0", pack_linear_colors(colors)});
  return write_fresh_gltf(mesh, format, encoding, name);
}

/// Not by the document that came, which would keep all it has a place for.
bool is_written_anew(Format came, Format wanted) {
  return came != wanted && (is_shape(came) || holds_one_mesh(wanted));
}

std::string_view upper_name(Format format) {
  if (format == Format::drc) return "Draco";
  if (format == Format::ply) return "PLY";
  if (format == Format::obj) return "OBJ";
  return "STL";
}

/// Extras, and what is told of those that could not be read.
struct CarriedExtras {
  VertexExtras extras;
  std::vector<std::string> notes;
};

/// What cannot be read is left out: nobody asked for it, and the mesh itself is good.
CarriedExtras carry_extras(const Document& document, const SurfaceResult& result) {
  CarriedExtras out;
  const ExtraKinds& kinds = document.facts().extras;
  const auto leave = [&](std::string_view what, const Error& why) {
    out.notes.push_back(fmt::format("{}: the {} of its vertices are left out. {}",
                                    document.surfaces().front().name, what, why.message));
  };
  if (kinds.color_components > 0 && !result.colors_vertices(true)) {
    auto colors = document.read_colors();
    if (colors) {
      out.extras.colors = *std::move(colors);
    } else {
      leave("colours", colors.error());
    }
  }
  if (!kinds.texture_coordinates) return out;
  auto texture_coordinates = document.read_texture_coordinates();
  if (texture_coordinates) {
    out.extras.texture_coordinates = *std::move(texture_coordinates);
  } else {
    leave("texture coordinates", texture_coordinates.error());
  }
  return out;
}

/// Extras and normals that the new file has no place for.
std::vector<std::string> lost_extras(const Document& document,
                                     std::span<const SurfaceResult> results, Format wanted) {
  std::vector<std::string> out;
  const ExtraKinds& extras = document.facts().extras;
  const std::vector<Surface>& surfaces = document.surfaces();
  if (wanted == Format::stl) {
    if (!surfaces.empty() && !surfaces.front().normals.empty()) {
      out.emplace_back("normals of vertices");
    }
    if (extras.color_components > 0) out.emplace_back("colours of vertices");
    if (extras.texture_coordinates) out.emplace_back("texture coordinates of vertices");
  }
  const bool replaced = !results.empty() && results.front().colors_vertices(true);
  if (wanted == Format::obj && extras.color_components == 4 && !replaced) {
    out.emplace_back("alpha of vertices");
  }
  return out;
}

}  // namespace

Result<Encoded> write_fresh_mesh(const Surface& surface, const SurfaceResult& result, Format format,
                                 const Encoding& encoding, VertexExtras extras) {
  if (result.colors_vertices(!extras.colors.empty())) {
    extras.colors = make_colors(result.colors->values);
  }
  const FreshParts parts{result.moved ? result.positions : surface.mesh.positions,
                         surface.mesh.triangles, result.moved ? result.normals : surface.normals,
                         result.attributes, extras};
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
  if (format == Format::drc) return write_fresh_draco(surface, result, encoding.draco, extras);
  if (!is_shape(format)) return write_gltf(parts, format, encoding, surface.name);
  return Encoded{ByteChain(write_fresh_shape(parts, format)), {}};
}

Result<Encoded> write_anew(const Document& document, const SurfaceResult& result, Format format,
                           const Encoding& encoding) {
  const Surface& surface = document.surfaces().front();
  CarriedExtras carried;
  if (format != Format::stl) carried = carry_extras(document, result);
  auto out = write_fresh_mesh(surface, result, format, encoding, std::move(carried.extras));
  if (!out) return out;
  out->notes.insert(out->notes.begin(), carried.notes.begin(), carried.notes.end());
  return out;
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
  return write_anew(document, results.front(), wanted, encoding);
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
  // A new OBJ has a place for colours, one that is patched keeps its lines.
  const bool takes_colors = wanted == Format::obj && came != Format::obj;
  bool homeless = false;
  for (const SurfaceResult& result : results) {
    homeless |= !result.attributes.empty() || (result.colors && !takes_colors);
  }
  if (homeless && (wanted == Format::obj || wanted == Format::stl)) {
    out.push_back(
        fmt::format("{} has no place for attributes of vertices: the curvature is not stored; ask "
                    "for ply or glb to get it",
                    upper_name(wanted)));
  }
  if (!is_written_anew(came, wanted)) return out;
  std::vector<std::string> lost = document.facts().left_behind;
  const std::vector<std::string> homeless_extras = lost_extras(document, results, wanted);
  lost.insert(lost.end(), homeless_extras.begin(), homeless_extras.end());
  if (lost.empty()) return out;
  out.push_back(
      fmt::format("written anew as {}, without {}", name_of(wanted), fmt::join(lost, ", ")));
  return out;
}

std::vector<std::string> kept_color_notes(const Document& document,
                                          std::span<const SurfaceResult> results,
                                          const Conversion& conversion) {
  const auto& [came, wanted, encoding] = conversion;
  const std::vector<Surface>& surfaces = document.surfaces();
  // In a new file colours stand at all vertices or at none.
  const bool anew = is_written_anew(came, wanted);
  const bool all = document.facts().extras.color_components > 0 && wanted != Format::stl;
  std::size_t kept = 0;
  std::string first;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    for (const PrimitiveVertices& primitive : surfaces[i].primitives) {
      const bool has_colors = anew ? all : primitive.has_colors;
      if (!results[i].colors || results[i].colors_vertices(has_colors)) continue;
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
