// Vertices as the file has them.

#include "proto/formats/surface_weld.h"

#include <map>
#include <optional>
#include <utility>

namespace fairway {

Weld weld_elements(const Surface& surface) {
  Weld weld;
  weld.place.assign(surface.mesh.positions.size(), kNoIndex);
  std::map<std::pair<std::size_t, std::optional<std::size_t>>, Index> first_of;
  for (const PrimitiveVertices& primitive : surface.primitives) {
    const auto [found, is_new] =
        first_of.try_emplace({primitive.accessor, primitive.draco_view}, primitive.first);
    if (is_new || found->second == primitive.first) continue;
    for (Index i = 0; i < primitive.count; ++i) {
      weld.place[primitive.first + i] = found->second + i;
    }
  }
  // Copies stand behind their originals.
  for (Index i = 0; i < weld.place.size(); ++i) {
    Index& place = weld.place[i];
    place = place == kNoIndex ? static_cast<Index>(weld.count++) : weld.place[place];
  }
  return weld;
}

}  // namespace fairway
