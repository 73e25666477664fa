// A bare Draco mesh as a Document. Its vertices are Draco's points; it comes back as Draco with
// all other attributes and metadata, or as a new glTF with those that have a place there.

#include "proto/formats/draco_document.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proto/formats/draco_decoder.h"
#include "proto/formats/draco_extras.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_compression.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

constexpr const char* kColors = "COLOR_0";
constexpr const char* kTextureCoordinates = "TEXCOORD_0";

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
    facts_.extras = kinds();
    const auto carried = static_cast<std::size_t>(facts_.extras.color_components > 0) +
                         static_cast<std::size_t>(facts_.extras.texture_coordinates);
    if (kept_.size() > carried) {
      facts_.left_behind.push_back(counted(kept_.size() - carried, "other attribute"));
    }
  }

  Result<Encoded> write(std::span<const SurfaceResult> results, Format format,
                        const Encoding& encoding) const override {
    if (const auto done = check_results(surfaces_, results); !done) return done.error();
    if (format == Format::drc) return write_draco(results.front(), encoding.draco);
    return write_gltf(results.front(), format, encoding);
  }

  Result<ColorValues> read_colors() const override {
    const DracoAttribute* colors = find(kColors);
    return colors == nullptr ? ColorValues{} : draco_colors(mesh_, *colors);
  }
  Result<std::vector<float>> read_texture_coordinates() const override {
    const DracoAttribute* values = find(kTextureCoordinates);
    return values == nullptr ? std::vector<float>{} : draco_texture_coordinates(mesh_, *values);
  }

 private:
  ExtraKinds kinds() const;
  const DracoAttribute* find(std::string_view gltf_name) const;
  std::vector<std::string> add_kept(const SurfaceResult& result, FreshMesh& mesh) const;
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

const DracoAttribute* DracoDocument::find(std::string_view gltf_name) const {
  const auto at = std::find_if(kept_.begin(), kept_.end(),
                               [&](const KeptAttribute& kept) { return kept.name == gltf_name; });
  return at == kept_.end() ? nullptr : at->attribute;
}

ExtraKinds DracoDocument::kinds() const {
  const DracoAttribute* color = find(kColors);
  return {color == nullptr ? 0 : color->components, find(kTextureCoordinates) != nullptr};
}

/// What cannot be read is left out, which the notes say.
std::vector<std::string> DracoDocument::add_kept(const SurfaceResult& result,
                                                 FreshMesh& mesh) const {
  std::vector<std::string> notes;
  for (const auto& [attribute, name] : kept_) {
    if (name.empty()) {
      notes.push_back(fmt::format("Draco attribute {} has no place in glTF and is left out",
                                  attribute->unique_id));
    }
    const bool recolored = name == kColors && result.colors_vertices(true);
    if (name.empty() || replaces(result, name) || recolored) continue;
    auto packed = pack_for_gltf(mesh_, *attribute);
    if (packed) {
      mesh.attributes.push_back({name, *std::move(packed)});
    } else {
      notes.push_back(fmt::format("Draco attribute {} is left out. {}", attribute->unique_id,
                                  packed.error().message));
    }
  }
  return notes;
}

Result<Encoded> DracoDocument::write_gltf(const SurfaceResult& result, Format format,
                                          Encoding encoding) const {
  const Surface& surface = surfaces_.front();
  FreshMesh mesh;
  mesh.triangles = surface.mesh.triangles;
  mesh.attributes.push_back(
      {"POSITION", pack_vectors(result.moved ? result.positions : surface.mesh.positions)});
  if (!surface.normals.empty()) {
    mesh.attributes.push_back(
        {"NORMAL", pack_vectors(result.moved ? result.normals : surface.normals)});
  }
  const std::vector<std::string> notes = add_kept(result, mesh);
  for (const VertexAttribute& attribute : result.attributes) {
    mesh.attributes.push_back(
        {attribute.name, pack_floats(attribute.values, attribute.components)});
  }
  const bool has_colors =
      std::any_of(mesh.attributes.begin(), mesh.attributes.end(),
                  [](const FreshMesh::Attribute& written) { return written.name == kColors; });
  if (result.colors_vertices(has_colors)) {
    mesh.attributes.push_back({kColors, pack_linear_colors(result.colors->values)});
  }
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
