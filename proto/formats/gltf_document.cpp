// A glTF as a Document: bytes → DOM → tables → surfaces, and back by patching the DOM.

#include "proto/formats/gltf_document.h"

#include "proto/formats/glb.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_extras.h"
#include "proto/formats/gltf_facts.h"
#include "proto/formats/gltf_nodes.h"
#include "proto/formats/gltf_patch.h"
#include "proto/formats/gltf_scene.h"
#include "proto/formats/gltf_surfaces.h"
#include "proto/formats/gltf_text.h"

namespace fairway {
namespace {

class GltfDocument final : public Document {
 public:
  GltfDocument(Json json, GltfTables tables, GltfSurfaces surfaces, GltfBinary binary)
      : json_(std::move(json)),
        tables_(std::move(tables)),
        layout_(std::move(surfaces.layout)),
        binary_(std::move(binary)) {
    scene_ = outline_scene(JsonPlace(json_, ""));
    surfaces_ = std::move(surfaces.surfaces);
    notes_ = std::move(surfaces.notes);
    facts_ =
        gltf_facts(json_, surfaces_.size() == 1 ? gltf_extra_kinds(tables_, layout_.plans.front())
                                                : ExtraKinds{});
  }

  Result<ColorValues> read_colors() const override {
    return read_gltf_colors(tables_, layout_, layout_.plans.front());
  }
  Result<std::vector<float>> read_texture_coordinates() const override {
    return read_gltf_texture_coordinates(tables_, layout_, layout_.plans.front());
  }

  Result<Encoded> write(std::span<const SurfaceResult> results, Format format,
                        const Encoding& encoding) const override {
    if (format != Format::glb && format != Format::gltf) {
      return Error{ErrorCode::unsupported_feature,
                   "A scene is not written as one mesh; ask for glb or gltf."};
    }
    GltfOutput output(json_, binary_, format);
    auto notes = patch_surfaces(tables_, layout_, surfaces_, results, encoding, output);
    if (!notes) return notes.error();
    auto bytes = output.finish();
    if (!bytes) return bytes.error();
    return Encoded{*std::move(bytes), *std::move(notes)};
  }

 private:
  Json json_;
  GltfTables tables_;
  GltfLayout layout_;
  GltfBinary binary_;
};

/// The text of a .gltf, without the byte order mark that some writers put before it.
Result<GlbParts> take_apart(ByteSpan bytes, Format format) {
  if (format == Format::glb) return parse_glb(bytes);
  if (bytes.empty()) {
    return Error{ErrorCode::malformed_input, "The file is empty; send the whole file."};
  }
  GlbParts parts;
  parts.json = as_text(bytes);
  return parts;
}

Result<GltfBinary> gather_binary(const JsonPlace& root, const GlbParts& parts, Format format,
                                 const GltfTables& tables, SideReader& reader,
                                 std::vector<std::string>& notes) {
  GltfBinary binary;
  binary.is_glb = format == Format::glb;
  binary.bin = parts.bin;
  binary.other_chunks = parts.other_chunks;
  if (!tables.buffers.empty()) binary.first_buffer = tables.buffers.front().data;
  for (std::size_t i = 0; i < tables.buffers.size(); ++i) {
    const GltfBuffer& buffer = tables.buffers[i];
    if (buffer.is_side_file) binary.side_buffers.push_back({i, *buffer.data});
  }
  auto images = read_side_images(root, reader, notes);
  if (!images) return images.error();
  binary.side_images = *std::move(images);
  return binary;
}

}  // namespace

Result<std::unique_ptr<Document>> decode_gltf(ByteSpan bytes, Format format,
                                              const SideFiles& side_files) {
  const auto parts = take_apart(bytes, format);
  if (!parts) return parts.error();
  if (const auto done = check_gltf_text(parts->json); !done) return done.error();
  auto json = parse_json(parts->json);
  if (!json) return json.error();
  const JsonPlace root(*json, "");
  if (const auto done = check_scene(root); !done) return done.error();
  if (const auto done = check_extensions(root); !done) return done.error();
  SideReader reader(side_files);
  auto tables = read_tables(root, parts->bin, bytes.size(), reader);
  if (!tables) return tables.error();
  auto surfaces = gather_surfaces(root, *tables);
  if (!surfaces) return surfaces.error();
  auto binary = gather_binary(root, *parts, format, *tables, reader, surfaces->notes);
  if (!binary) return binary.error();
  return std::unique_ptr<Document>(std::make_unique<GltfDocument>(
      *std::move(json), *std::move(tables), *std::move(surfaces), *std::move(binary)));
}

}  // namespace fairway
