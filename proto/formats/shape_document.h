#pragma once

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"

namespace fairway {

/// A file of one mesh without a scene: PLY, OBJ, STL. In its own format it comes back patched, as
/// any other it is written anew.
class ShapeDocument : public Document {
 public:
  Result<Encoded> write(std::span<const SurfaceResult> results, Format format,
                        const Encoding& encoding) const final;

 protected:
  ShapeDocument(ByteSpan source, Format format) : source_(source), format_(format) {}

  /// The file with `result` in place; results that change nothing do not come here.
  virtual Result<std::vector<std::byte>> patch(const SurfaceResult& result) const = 0;
  /// Whether the format has a place for attributes of vertices.
  virtual bool holds_attributes() const { return false; }

  ByteSpan source() const { return source_; }

 private:
  ByteSpan source_;
  Format format_;
};

/// Errors of all three: malformed_input, invalid_mesh, no_triangles, too_large.
/// PLY 1.0, ascii and binary of either byte order; faces, or tristrips where there are none. Also
/// unsupported_feature (coordinates that are not floating point).
Result<std::unique_ptr<Document>> decode_ply(ByteSpan bytes);
/// Polygonal Wavefront OBJ. No file that it names is opened.
Result<std::unique_ptr<Document>> decode_obj(ByteSpan bytes);
/// Binary and ASCII STL. Equal corners are one vertex, numbered by first appearance.
Result<std::unique_ptr<Document>> decode_stl(ByteSpan bytes);

}  // namespace fairway
