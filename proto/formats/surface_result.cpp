// Results must fit the surfaces they are written back to.

#include "proto/formats/surface_result.h"

#include <fmt/format.h>

#include "proto/formats/finite.h"

namespace fairway {
namespace {

constexpr int kMostComponents = 4;

Error unfit(const Surface& surface, std::string_view what) {
  return {ErrorCode::internal, fmt::format("{}: {} do not fit the surface.", surface.name, what)};
}

Result<void> check_result(const Surface& surface, const SurfaceResult& result) {
  const std::size_t vertices = surface.mesh.positions.size();
  if (result.moved) {
    if (result.positions.size() != vertices) return unfit(surface, "positions");
    if (!surface.normals.empty() && result.normals.size() != vertices) {
      return unfit(surface, "normals");
    }
    if (vertices > 0 && !all_finite_as_floats({result.positions.data()->data(), 3 * vertices})) {
      return Error{ErrorCode::diverged,
                   "A position left the range of single precision; use fewer or smaller steps."};
    }
  }
  if (result.colors && result.colors->values.size() != vertices) return unfit(surface, "colours");
  for (const VertexAttribute& attribute : result.attributes) {
    if (attribute.components < 1 || attribute.components > kMostComponents ||
        attribute.values.size() != vertices * static_cast<std::size_t>(attribute.components)) {
      return unfit(surface, attribute.name);
    }
  }
  return {};
}

}  // namespace

Result<void> check_results(std::span<const Surface> surfaces,
                           std::span<const SurfaceResult> results) {
  if (results.size() != surfaces.size()) {
    return Error{ErrorCode::internal, "There is not one result per surface."};
  }
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (auto done = check_result(surfaces[i], results[i]); !done) return done;
  }
  return {};
}

}  // namespace fairway
