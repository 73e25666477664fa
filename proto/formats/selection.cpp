// From the meshes and nodes that a client names to the surfaces of a file.

#include "proto/formats/selection.h"

#include <algorithm>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Names in a sentence.
constexpr std::size_t kMostNames = 10;

Error refusal(std::string message, std::string_view list, std::size_t entry) {
  return {ErrorCode::invalid_parameters, std::move(message), fmt::format("/{}/{}", list, entry)};
}

/// Marks the surface of a mesh; false where it has none.
bool mark(std::span<const Surface> surfaces, std::size_t mesh, std::vector<bool>& selected) {
  const auto found =
      std::lower_bound(surfaces.begin(), surfaces.end(), mesh,
                       [](const Surface& s, std::size_t index) { return s.mesh_index < index; });
  if (found == surfaces.end() || found->mesh_index != mesh) return false;
  selected[static_cast<std::size_t>(found - surfaces.begin())] = true;
  return true;
}

Result<void> add_meshes(const Document& document, std::span<const Index> meshes,
                        std::vector<bool>& selected) {
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (mark(document.surfaces(), meshes[i], selected)) continue;
    if (!document.scene()) {
      return refusal("The file has one mesh without a scene: mesh 0.", "meshes", i);
    }
    const std::size_t count = document.scene()->meshes;
    return refusal(
        meshes[i] < count
            ? fmt::format("Mesh {} has no triangles to denoise; leave it out.", meshes[i])
            : fmt::format("Mesh {} is not among the file's {}; count from 0.", meshes[i], count),
        "meshes", i);
  }
  return {};
}

Result<void> add_nodes(const Document& document, std::span<const Index> nodes,
                       std::vector<bool>& selected) {
  if (!document.scene() && !nodes.empty()) {
    return Error{ErrorCode::invalid_parameters,
                 "The file has no scene, so it has no nodes; leave \"nodes\" out.", "/nodes"};
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& mesh_of_node = document.scene()->mesh_of_node;
    if (nodes[i] >= mesh_of_node.size()) {
      return refusal(fmt::format("Node {} is not among the file's {}; count from 0.", nodes[i],
                                 mesh_of_node.size()),
                     "nodes", i);
    }
    const auto mesh = mesh_of_node[nodes[i]];
    if (mesh && mark(document.surfaces(), *mesh, selected)) continue;
    return refusal(fmt::format("Node {} has no mesh with triangles of its own; name the nodes "
                               "that have one.",
                               nodes[i]),
                   "nodes", i);
  }
  return {};
}

}  // namespace

Result<std::vector<bool>> select_surfaces(const Document& document,
                                          const MeshSelection& selection) {
  std::vector<bool> selected(document.surfaces().size(), selection.all());
  if (auto done = add_meshes(document, selection.meshes, selected); !done) return done.error();
  if (auto done = add_nodes(document, selection.nodes, selected); !done) return done.error();
  return selected;
}

std::string describe_selection(std::span<const Surface> surfaces,
                               const std::vector<bool>& selected) {
  std::string names;
  std::size_t left = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (selected[i]) continue;
    if (++left <= kMostNames) names += (names.empty() ? "" : ", ") + surfaces[i].name;
  }
  if (left == 0) return {};
  if (left > kMostNames) names += fmt::format(" and {} more", left - kMostNames);
  return fmt::format("not selected, so left as they are: {}", names);
}

}  // namespace fairway
