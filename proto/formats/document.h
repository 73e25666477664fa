#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/byte_chain.h"
#include "proto/formats/side_files.h"
#include "proto/formats/vertex_colors.h"
#include "proto/formats/vertex_extras.h"
#include "proto/messages/encoding.h"
#include "proto/messages/format.h"

namespace fairway {

/// The vertices that one triangle primitive draws from: the elements of its POSITION accessor.
struct PrimitiveVertices {
  std::size_t primitive = 0;                   ///< in "primitives" of the mesh; 0 for a Draco mesh
  std::size_t accessor = 0;                    ///< POSITION
  std::optional<std::size_t> draco_view = {};  ///< that the accessor's elements are decoded from
  Index first = 0;                             ///< vertex of the surface that is element 0
  Index count = 0;
  bool has_colors = false;  ///< COLOR_0 and what corresponds to it
};

/// The uniform scale at which a mesh stands in its scene, 1 where there is no scene.
struct WorldScale {
  double value = 1.0;         ///< > 0
  std::string_view why_none;  ///< why there is no such scale; "" where there is
};

/// One surface of a document in its local space: the mesh of a file without a scene (Draco, PLY,
/// OBJ, STL; "mesh_index", "primitive" and "accessor" are 0), or all triangle primitives of one
/// glTF mesh together. Vertices are those of the distinct POSITION accessors, one after the other.
struct Surface {
  std::string name;  ///< "meshes/0" …: a place in the document, never text from the file
  IndexedMesh mesh;
  std::size_t mesh_index = 0;                 ///< in "meshes"; 0 for a Draco mesh
  std::vector<PrimitiveVertices> primitives;  ///< ascending; several may share vertices
  /// Old normals, one per vertex, zero where the file has none; empty if it has none at all.
  std::vector<Vec3> normals;
  bool single_precision = true;  ///< the file holds positions as floats
  WorldScale world_scale;
};

/// A per-vertex attribute to add. `values` has `components` floats (1 or 3) per vertex, all finite.
struct VertexAttribute {
  std::string name;
  int components = 1;
  std::vector<float> values;
};

/// What became of one Surface.
struct SurfaceResult {
  bool moved = false;           ///< false: positions and normals of the file stay as they are
  std::vector<Vec3> positions;  ///< one per vertex of Surface::mesh, if moved
  std::vector<Vec3> normals;    ///< the same, if moved and the surface has normals
  std::vector<VertexAttribute> attributes;
  std::optional<VertexColors> colors = {};
  bool untouched = false;  ///< nothing of the surface is written, whatever the encoding

  /// Whether vertices with or without colours in the file get the new ones.
  bool colors_vertices(bool has_colors) const { return colors && (colors->replace || !has_colors); }
};

/// A written file. Its bytes refer to the document, to the bytes it was decoded from and to the
/// results in it, which must outlive them.
struct Encoded {
  ByteChain bytes;
  std::vector<std::string> notes;  ///< sentences for the job's notes: errors of quantisation …
};

/// A file as it came.
Encoded unchanged(ByteSpan bytes);

/// "1 mesh", "3 meshes": English plurals of what files count.
std::string counted(std::size_t count, std::string_view name);

/// What a file holds beside positions and triangles.
struct FileFacts {
  std::size_t meshes = 1;
  std::size_t primitives = 1;  ///< of all kinds
  /// What write_fresh_mesh() does not carry over: "3 materials", "transformations of nodes" …
  std::vector<std::string> left_behind;
  ExtraKinds extras;  ///< that it carries over where the format has a place for them
  /// Sentences about parts that a job does not compute with and that are no matter for its notes.
  std::vector<std::string> untouched;
};

/// What a client can name in the scene of a glTF.
struct SceneOutline {
  std::size_t meshes = 0;
  std::vector<std::optional<std::size_t>> mesh_of_node;  ///< one per node
};

/// A decoded file: its surfaces, and all that is needed to write it back with nothing else changed.
class Document {
 public:
  virtual ~Document() = default;

  const std::vector<Surface>& surfaces() const { return surfaces_; }
  /// Sentences for the job's notes ("skinned: the bind pose is denoised").
  const std::vector<std::string>& notes() const { return notes_; }

  const FileFacts& facts() const { return facts_; }
  /// Nothing for a file without a scene.
  const std::optional<SceneOutline>& scene() const { return scene_; }

  /// The file with `results` (one per surface, in order) in place, as `format`.
  /// Errors: unsupported_feature (a format this document cannot become), too_large.
  virtual Result<Encoded> write(std::span<const SurfaceResult> results, Format format,
                                const Encoding& encoding) const = 0;

  /// The extras that facts() lists, one after the other for each vertex. They are read when they
  /// are asked for. Errors: invalid_mesh, unsupported_feature, too_large (what cannot be read).
  virtual Result<ColorValues> read_colors() const { return ColorValues{}; }
  virtual Result<std::vector<float>> read_texture_coordinates() const {
    return std::vector<float>{};
  }

  /// The bytes of write() with the default encoding.
  Result<std::vector<std::byte>> encode(std::span<const SurfaceResult> results,
                                        Format format) const;

 protected:
  std::vector<Surface> surfaces_;
  std::vector<std::string> notes_;
  FileFacts facts_;
  std::optional<SceneOutline> scene_;
};

/// Decodes untrusted bytes; every count is checked before it is believed. `bytes` must outlive the
/// Document, which refers to them. Opens no file and no network address; what a glTF names beside
/// itself comes from `side_files`.
/// Errors: malformed_input, unsupported_format, unsupported_feature, invalid_mesh, no_triangles,
/// too_large; JSON pointers name the culprit in a glTF.
Result<std::unique_ptr<Document>> decode(std::span<const std::byte> bytes, Format format,
                                         const SideFiles& side_files = {});

}  // namespace fairway
