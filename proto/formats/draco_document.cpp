// A bare Draco mesh as a Document. Its vertices are Draco's points; it comes back as a new glTF.

#include "proto/formats/draco_document.h"

#include <cmath>

#include <fmt/format.h>

#include "proto/formats/draco_decoder.h"
#include "proto/formats/fresh_gltf.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

std::vector<Vec3> to_vectors(const std::vector<double>& values) {
  std::vector<Vec3> out;
  out.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    out.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  return out;
}

class DracoDocument final : public Document {
 public:
  DracoDocument(Surface surface, std::vector<FreshMesh::Attribute> kept,
                std::vector<std::string> notes)
      : kept_(std::move(kept)) {
    surfaces_.push_back(std::move(surface));
    notes_ = std::move(notes);
  }

  Result<std::vector<std::byte>> encode(std::span<const SurfaceResult> results,
                                        Format format) const override;

 private:
  std::vector<FreshMesh::Attribute> kept_;  ///< texture coordinates, colours
};

Result<std::vector<std::byte>> DracoDocument::encode(std::span<const SurfaceResult> results,
                                                     Format format) const {
  if (format == Format::drc) {
    return Error{ErrorCode::unsupported_feature,
                 "Writing .drc is not there yet; ask for glb or gltf."};
  }
  const Surface& surface = surfaces_.front();
  if (const auto done = check_results(surfaces_, results); !done) return done.error();
  const SurfaceResult& result = results.front();
  FreshMesh mesh;
  mesh.triangles = surface.mesh.triangles;
  mesh.attributes.push_back(
      {"POSITION", pack_vectors(result.moved ? result.positions : surface.mesh.positions)});
  if (!surface.normals.empty()) {
    mesh.attributes.push_back(
        {"NORMAL", pack_vectors(result.moved ? result.normals : surface.normals)});
  }
  mesh.attributes.insert(mesh.attributes.end(), kept_.begin(), kept_.end());
  for (const VertexAttribute& attribute : result.attributes) {
    mesh.attributes.push_back(
        {attribute.name, pack_floats(attribute.values, attribute.components)});
  }
  return write_fresh_gltf(mesh, format);
}

Result<Surface> read_surface(const DracoMesh& mesh) {
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
  surface.mesh.triangles = mesh.triangles();
  surface.primitives.push_back({.count = static_cast<Index>(surface.mesh.positions.size())});
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

/// The name a Draco attribute gets in glTF, "" if it has no place there.
std::string gltf_name(const DracoAttribute& attribute, int& texture_coordinates, int& colors) {
  const bool fits_texture = attribute.components == 2;
  const bool fits_color = attribute.components == 3 || attribute.components == 4;
  if (attribute.kind == DracoKind::tex_coord && fits_texture) {
    return fmt::format("TEXCOORD_{}", texture_coordinates++);
  }
  if (attribute.kind == DracoKind::color && fits_color) return fmt::format("COLOR_{}", colors++);
  return {};
}

Result<std::vector<FreshMesh::Attribute>> read_kept(const DracoMesh& mesh,
                                                    std::vector<std::string>& notes) {
  std::vector<FreshMesh::Attribute> out;
  int texture_coordinates = 0;
  int colors = 0;
  for (const DracoAttribute& attribute : mesh.attributes()) {
    if (&attribute == mesh.find(DracoKind::position) ||
        &attribute == mesh.find(DracoKind::normal)) {
      continue;
    }
    const std::string name = gltf_name(attribute, texture_coordinates, colors);
    if (name.empty()) {
      notes.push_back(fmt::format("Draco attribute {} has no place in glTF and is left out",
                                  attribute.unique_id));
      continue;
    }
    const auto values = mesh.values(attribute);
    if (!values) return values.error();
    // Both are floats or normalized u8 and u16 in glTF.
    const bool integer =
        attribute.type == ComponentType::u8 || attribute.type == ComponentType::u16;
    const ComponentType type = integer ? *attribute.type : ComponentType::f32;
    out.push_back({name, pack_values(*values, {type, integer, attribute.components})});
  }
  return out;
}

}  // namespace

Result<std::unique_ptr<Document>> decode_drc(ByteSpan bytes) {
  const auto mesh = DracoMesh::decode(bytes);
  if (!mesh) return mesh.error();
  if (mesh->triangles().empty()) {
    return Error{ErrorCode::no_triangles, "The Draco mesh has no triangles to denoise."};
  }
  auto surface = read_surface(*mesh);
  if (!surface) return surface.error();
  std::vector<std::string> notes;
  auto kept = read_kept(*mesh, notes);
  if (!kept) return kept.error();
  return std::unique_ptr<Document>(
      std::make_unique<DracoDocument>(*std::move(surface), *std::move(kept), std::move(notes)));
}

}  // namespace fairway
