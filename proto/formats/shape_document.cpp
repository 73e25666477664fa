// What PLY, OBJ and STL documents share.

#include "proto/formats/shape_document.h"

#include "proto/formats/fresh_mesh.h"
#include "proto/formats/surface_result.h"

namespace fairway {

Result<std::vector<std::byte>> ShapeDocument::encode(std::span<const SurfaceResult> results,
                                                     Format format) const {
  if (const auto done = check_results(surfaces_, results); !done) return done.error();
  const SurfaceResult& result = results.front();
  if (format != format_) return write_fresh_mesh(surfaces_.front(), result, format);
  const bool adds = holds_attributes() && !result.attributes.empty();
  if (!result.moved && !adds) return std::vector<std::byte>(source_.begin(), source_.end());
  return patch(result);
}

}  // namespace fairway
