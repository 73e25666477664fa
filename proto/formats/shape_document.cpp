// What PLY, OBJ and STL documents share.

#include "proto/formats/shape_document.h"

#include "proto/formats/fresh_mesh.h"
#include "proto/formats/surface_result.h"

namespace fairway {

Result<Encoded> ShapeDocument::write(std::span<const SurfaceResult> results, Format format,
                                     const Encoding& encoding) const {
  if (const auto done = check_results(surfaces_, results); !done) return done.error();
  const SurfaceResult& result = results.front();
  if (format != format_) return write_anew(*this, result, format, encoding);
  const bool adds = holds_attributes() && (!result.attributes.empty() || result.colors);
  if (result.untouched || (!result.moved && !adds)) return unchanged(source_);
  auto bytes = patch(result);
  if (!bytes) return bytes.error();
  return Encoded{ByteChain(*std::move(bytes)), {}};
}

}  // namespace fairway
