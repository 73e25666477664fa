// From the vertices that a client names by their place in a file to those of its surfaces.

#include "proto/formats/fixed_vertices.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::string_view kPointer = "/fixed_vertices";

Error refusal(std::string message, std::string pointer) {
  return {ErrorCode::invalid_parameters, std::move(message), std::move(pointer)};
}

/// `vertices` of one list, as they are counted in a surface.
Result<void> add(std::span<const Index> vertices, const PrimitiveVertices& primitive,
                 const std::string& pointer, std::vector<Index>& out) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i] >= primitive.count) {
      return refusal(
          fmt::format("Fixed vertex {} is not among the {} of its primitive; count from 0.",
                      vertices[i], primitive.count),
          fmt::format("{}/{}", pointer, i));
    }
    out.push_back(primitive.first + vertices[i]);
  }
  return {};
}

void make_ascending(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// A list without a place: the file must leave no doubt which vertices are meant.
Result<void> add_everywhere(std::span<const Surface> surfaces, std::span<const Index> vertices,
                            std::vector<std::vector<Index>>& out) {
  const std::vector<PrimitiveVertices>& primitives = surfaces.front().primitives;
  const bool one_accessor =
      std::all_of(primitives.begin(), primitives.end(), [&](const PrimitiveVertices& p) {
        return p.accessor == primitives.front().accessor &&
               p.draco_view == primitives.front().draco_view;
      });
  if (surfaces.size() != 1 || !one_accessor) {
    return refusal(
        "The file has more than one list of vertices; name the mesh and the primitive of each: "
        "[{\"mesh\": 0, \"primitive\": 0, \"vertices\": [0, 1]}].",
        std::string(kPointer));
  }
  // Primitives may have copies of the vertices, with other normals: one of each place is enough.
  return add(vertices, primitives.front(), std::string(kPointer), out.front());
}

Result<void> add_at_place(std::span<const Surface> surfaces, const FixedVertices& fixed,
                          const std::string& pointer, std::vector<std::vector<Index>>& out) {
  const auto surface =
      std::lower_bound(surfaces.begin(), surfaces.end(), fixed.place->mesh,
                       [](const Surface& s, std::size_t mesh) { return s.mesh_index < mesh; });
  if (surface == surfaces.end() || surface->mesh_index != fixed.place->mesh) {
    return refusal(
        fmt::format("The file has no mesh {} with triangles; count from 0.", fixed.place->mesh),
        pointer + "/mesh");
  }
  const auto primitive = std::lower_bound(
      surface->primitives.begin(), surface->primitives.end(), fixed.place->primitive,
      [](const PrimitiveVertices& p, std::size_t index) { return p.primitive < index; });
  if (primitive == surface->primitives.end() || primitive->primitive != fixed.place->primitive) {
    return refusal(fmt::format("Mesh {} has no primitive {} with triangles; count from 0.",
                               fixed.place->mesh, fixed.place->primitive),
                   pointer + "/primitive");
  }
  return add(fixed.vertices, *primitive, pointer + "/vertices",
             out[static_cast<std::size_t>(surface - surfaces.begin())]);
}

}  // namespace

Result<std::vector<std::vector<Index>>> find_fixed_vertices(std::span<const Surface> surfaces,
                                                            std::span<const FixedVertices> fixed) {
  std::vector<std::vector<Index>> out(surfaces.size());
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const Result<void> added =
        fixed[i].place ? add_at_place(surfaces, fixed[i], fmt::format("{}/{}", kPointer, i), out)
                       : add_everywhere(surfaces, fixed[i].vertices, out);
    if (!added) return added.error();
  }
  for (std::vector<Index>& list : out) make_ascending(list);
  return out;
}

}  // namespace fairway
