// A bare Draco mesh as a Document. Its vertices are Draco's points; it comes back as Draco with
// all other attributes and metadata, or as a new glTF with those that have a place there.

#include "proto/formats/draco_document.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "proto/formats/draco_decoder.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_compression.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

/// Longest name of an attribute that is taken over into a glTF.
constexpr std::size_t kLongestName = 64;
constexpr const char* kColors = "COLOR_0";

std::vector<Vec3> to_vectors(const std::vector<double>& values) {
  std::vector<Vec3> out;
  out.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    out.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  return out;
}

/// An attribute that is neither the positions nor the normals, and its name in a glTF.
struct KeptAttribute {
  const DracoAttribute* attribute = nullptr;
  std::string name;  ///< "" if it has no place there
};

class DracoDocument final : public Document {
 public:
  DracoDocument(ByteSpan source, DracoMesh mesh, Surface surface, std::vector<KeptAttribute> kept)
      : source_(source), mesh_(std::move(mesh)), kept_(std::move(kept)) {
    surfaces_.push_back(std::move(surface));
    if (!kept_.empty()) facts_.left_behind.push_back(counted(kept_.size(), "other attribute"));
  }

  Result<Encoded> write(std::span<const SurfaceResult> results, Format format,
                        const Encoding& encoding) const override {
    if (const auto done = check_results(surfaces_, results); !done) return done.error();
    if (format == Format::drc) return write_draco(results.front(), encoding.draco);
    return write_gltf(results.front(), format, encoding);
  }

 private:
  Result<Encoded> write_draco(const SurfaceResult& result, const DracoOptions& options) const;
  Result<Encoded> write_gltf(const SurfaceResult& result, Format format, Encoding encoding) const;
  Result<DracoPart> kept_part(const DracoAttribute& attribute, const DracoOptions& options) const;
  std::optional<std::uint32_t> id_of(DracoKind kind) const;

  ByteSpan source_;
  DracoMesh mesh_;
  std::vector<KeptAttribute> kept_;  ///< point into mesh_
};

bool replaces(const SurfaceResult& result, std::string_view name) {
  return std::any_of(result.attributes.begin(), result.attributes.end(),
                     [name](const VertexAttribute& added) { return added.name == name; });
}

std::optional<std::uint32_t> DracoDocument::id_of(DracoKind kind) const {
  const DracoAttribute* attribute = mesh_.find(kind);
  return attribute == nullptr ? std::nullopt : std::optional(attribute->unique_id);
}

/// Integers and what nobody asked to compress stay as they are.
Result<DracoPart> DracoDocument::kept_part(const DracoAttribute& attribute,
                                           const DracoOptions& options) const {
  DracoPart part{.kind = attribute.kind,
                 .name = {},
                 .components = attribute.components,
                 .values = KeptDracoAttribute{&mesh_, attribute.id}};
  const bool texture = attribute.kind == DracoKind::tex_coord;
  if (attribute.type != ComponentType::f32 || !(texture || is_curvature_name(attribute.name))) {
    return part;
  }
  const auto values = mesh_.values(attribute);
  if (!values) return values.error();
  part.grid = make_grid(value_bounds(*values, attribute.components),
                        texture ? options.texcoord_bits : options.curvature_bits);
  return part;
}

Result<Encoded> DracoDocument::write_draco(const SurfaceResult& result,
                                           const DracoOptions& options) const {
  const DracoAttribute* old_color = mesh_.find(DracoKind::color);
  const bool colors = result.colors_vertices(old_color != nullptr);
  if (result.untouched || (!result.moved && result.attributes.empty() && !colors)) {
    return unchanged(source_);
  }
  const Surface& surface = surfaces_.front();
  const std::vector<Vec3>& positions = result.moved ? result.positions : surface.mesh.positions;
  const SurfaceGrids grids = make_surface_grids(positions, result.attributes, options);
  DracoSource source;
  source.triangles = surface.mesh.triangles;
  source.points = mesh_.point_count();
  source.metadata = &mesh_;
  source.parts.push_back(position_part(positions, grids.position));
  source.parts.back().unique_id = id_of(DracoKind::position);
  if (!surface.normals.empty()) {
    source.parts.push_back(normal_part(result.moved ? result.normals : surface.normals, options));
    source.parts.back().unique_id = id_of(DracoKind::normal);
  }
  for (const auto& [attribute, name] : kept_) {
    if (replaces(result, attribute->name) || (colors && attribute == old_color)) continue;
    auto part = kept_part(*attribute, options);
    if (!part) return part.error();
    source.parts.push_back(*std::move(part));
  }
  for (std::size_t i = 0; i < result.attributes.size(); ++i) {
    source.parts.push_back(
        attribute_part(result.attributes[i], grids.attributes[i], 0, source.points));
  }
  if (colors) {
    source.parts.push_back(color_part(*result.colors));
    source.parts.back().unique_id = id_of(DracoKind::color);
  }
  auto stream =
      encode_draco(source, options.level, options.keep_order ? DracoOrder::kept : DracoOrder::free);
  if (!stream) return stream.error();
  return Encoded{ByteChain(std::move(stream->bytes)),
                 {describe_surface(surface.name, grids, result.attributes)}};
}

/// Bytes and shorts keep their type; of the larger ones glTF knows only floats in a vertex.
Packing packing_of(const DracoAttribute& attribute) {
  const bool color = attribute.kind == DracoKind::color;
  const bool texture = attribute.kind == DracoKind::tex_coord;
  const bool small = attribute.type == ComponentType::u8 || attribute.type == ComponentType::u16;
  const bool signed_small =
      attribute.type == ComponentType::i8 || attribute.type == ComponentType::i16;
  if (color || texture) {
    // Both are floats or normalized u8 and u16 in glTF.
    return {small ? *attribute.type : ComponentType::f32, small, attribute.components};
  }
  const bool fits = small || signed_small;
  return {fits ? *attribute.type : ComponentType::f32, fits && attribute.normalized,
          attribute.components};
}

Result<Encoded> DracoDocument::write_gltf(const SurfaceResult& result, Format format,
                                          Encoding encoding) const {
  const Surface& surface = surfaces_.front();
  const bool has_colors = std::any_of(
      kept_.begin(), kept_.end(), [](const KeptAttribute& kept) { return kept.name == kColors; });
  const bool colors = result.colors_vertices(has_colors);
  FreshMesh mesh;
  std::vector<std::string> notes;
  mesh.triangles = surface.mesh.triangles;
  mesh.attributes.push_back(
      {"POSITION", pack_vectors(result.moved ? result.positions : surface.mesh.positions)});
  if (!surface.normals.empty()) {
    mesh.attributes.push_back(
        {"NORMAL", pack_vectors(result.moved ? result.normals : surface.normals)});
  }
  for (const auto& [attribute, name] : kept_) {
    if (name.empty()) {
      notes.push_back(fmt::format("Draco attribute {} has no place in glTF and is left out",
                                  attribute->unique_id));
    }
    if (name.empty() || replaces(result, name) || (colors && name == kColors)) continue;
    const auto values = mesh_.values(*attribute);
    if (!values) return values.error();
    mesh.attributes.push_back({name, pack_values(*values, packing_of(*attribute))});
  }
  for (const VertexAttribute& attribute : result.attributes) {
    mesh.attributes.push_back(
        {attribute.name, pack_floats(attribute.values, attribute.components)});
  }
  if (colors) mesh.attributes.push_back({kColors, pack_linear_colors(result.colors->values)});
  // It came as Draco.
  if (encoding.compression == Compression::keep) encoding.compression = Compression::draco;
  auto written = write_fresh_gltf(mesh, format, encoding, surface.name);
  if (!written) return written.error();
  written->notes.insert(written->notes.begin(), notes.begin(), notes.end());
  return written;
}

Result<Surface> read_surface(DracoMesh& mesh) {
  const DracoAttribute* position = mesh.find(DracoKind::position);
  if (position == nullptr || position->components != 3) {
    return Error{ErrorCode::invalid_mesh,
                 "The Draco mesh has no positions of three components; encode it again."};
  }
  const auto positions = mesh.values(*position);
  if (!positions) return positions.error();
  Surface surface;
  surface.name = "mesh";
  surface.mesh.positions = to_vectors(*positions);
  surface.mesh.triangles = mesh.take_triangles();
  surface.primitives.push_back({.count = static_cast<Index>(surface.mesh.positions.size()),
                                .has_colors = mesh.find(DracoKind::color) != nullptr});
  for (std::size_t i = 0; i < surface.mesh.positions.size(); ++i) {
    if (!surface.mesh.positions[i].cast<float>().allFinite()) {
      return Error{
          ErrorCode::invalid_mesh,
          fmt::format("The position of vertex {} is not finite; remove such vertices.", i)};
    }
  }
  const DracoAttribute* normal = mesh.find(DracoKind::normal);
  if (normal == nullptr || normal->components != 3) return surface;
  const auto normals = mesh.values(*normal);
  if (!normals) return normals.error();
  surface.normals = to_vectors(*normals);
  for (Vec3& n : surface.normals) {
    const double length = n.norm();
    n = length > 0.0 && std::isfinite(length) ? Vec3(n / length) : Vec3(Vec3::Zero());
  }
  return surface;
}

/// A name that an application may give to an attribute in glTF.
bool is_custom_name(std::string_view name) {
  return name.starts_with('_') && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                  (c >= 'a' && c <= 'z');
         });
}

/// Hands out the names that Draco attributes get in glTF.
class GltfNames {
 public:
  /// "" for an attribute without a place there.
  std::string name(const DracoAttribute& attribute) {
    const bool fits_color = attribute.components == 3 || attribute.components == 4;
    if (attribute.kind == DracoKind::tex_coord && attribute.components == 2) {
      return fmt::format("TEXCOORD_{}", texture_coordinates_++);
    }
    if (attribute.kind == DracoKind::color && fits_color) {
      return fmt::format("COLOR_{}", colors_++);
    }
    const bool fits = attribute.components >= 1 && attribute.components <= 4;
    if (attribute.kind != DracoKind::generic || !fits || !is_custom_name(attribute.name)) return {};
    return names_.insert(attribute.name).second ? attribute.name : std::string();
  }

 private:
  int texture_coordinates_ = 0;
  int colors_ = 0;
  std::set<std::string, std::less<>> names_;
};

Result<std::vector<KeptAttribute>> list_kept(const DracoMesh& mesh) {
  std::vector<KeptAttribute> out;
  GltfNames names;
  for (const DracoAttribute& attribute : mesh.attributes()) {
    const bool is_position = &attribute == mesh.find(DracoKind::position);
    const bool is_normal = &attribute == mesh.find(DracoKind::normal);
    if (is_position || (is_normal && attribute.components == 3)) continue;
    if (!mesh.check_values(attribute)) {
      return Error{ErrorCode::invalid_mesh,
                   "The Draco mesh has points without values; encode it again."};
    }
    out.push_back({&attribute, names.name(attribute)});
  }
  return out;
}

}  // namespace

Result<std::unique_ptr<Document>> decode_drc(ByteSpan bytes) {
  auto mesh = DracoMesh::decode(bytes);
  if (!mesh) return mesh.error();
  if (mesh->triangles().empty()) {
    return Error{ErrorCode::no_triangles, "The Draco mesh has no triangles to denoise."};
  }
  auto surface = read_surface(*mesh);
  if (!surface) return surface.error();
  auto kept = list_kept(*mesh);
  if (!kept) return kept.error();
  return std::unique_ptr<Document>(std::make_unique<DracoDocument>(
      bytes, *std::move(mesh), *std::move(surface), *std::move(kept)));
}

}  // namespace fairway
