// Feature vertices of a surface at rest, and flags on their way between surface and source
// vertices. Source: Hildebrandt & Polthier 2004, the text before eq. (11).

#include "core/features.h"

#include "core/edge_geometry.h"
#include "core/surface_geometry.h"

namespace fairway {
namespace {

/// Flags of places from the flags of their surface vertices, for places up to the last one used.
std::vector<unsigned char> flags_of_places(const TriangleMesh& mesh,
                                           std::span<const unsigned char> flags) {
  const std::vector<Index>& place = mesh.place_of_vertex();
  std::vector<unsigned char> out(std::size_t{place.back()} + 1, 0);
  for (std::size_t v = 0; v < place.size(); ++v) out[place[v]] |= flags[v];
  return out;
}

}  // namespace

std::vector<unsigned char> feature_vertices(const TriangleMesh& mesh,
                                            std::span<const Vec3> positions,
                                            const FeatureRule& rule) {
  const double smallest = smallest_area(mean_edge_length(mesh, positions));
  const FaceGeometry faces = face_geometry(mesh, positions, smallest);
  const EdgeCurvature edges = edge_mean_curvature(mesh, positions, faces);
  // Who is a feature does not depend on how much its edges count.
  constexpr double kAnyTransition = 1.0;
  return detect_features(mesh, edges, rule.lambda, kAnyTransition, rule.min_component).vertex;
}

std::vector<unsigned char> scatter_flags(const TriangleMesh& mesh,
                                         std::span<const unsigned char> flags) {
  const std::vector<unsigned char> of_place = flags_of_places(mesh, flags);
  std::vector<unsigned char> out;
  out.reserve(mesh.place_of_source().size());
  for (const Index place : mesh.place_of_source()) {
    out.push_back(place < of_place.size() ? of_place[place] : 0);
  }
  return out;
}

std::vector<unsigned char> gather_flags(const TriangleMesh& mesh, std::span<const Index> sources) {
  const std::vector<Index>& place = mesh.place_of_vertex();
  std::vector<unsigned char> of_place(std::size_t{place.back()} + 1, 0);
  for (const Index source : sources) {
    const Index at = mesh.place_of_source()[source];
    if (at < of_place.size()) of_place[at] = 1;
  }
  std::vector<unsigned char> out;
  out.reserve(place.size());
  for (const Index at : place) out.push_back(of_place[at]);
  return out;
}

}  // namespace fairway
