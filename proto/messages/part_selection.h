#pragma once

#include <optional>
#include <vector>

#include "core/index.h"
#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// Vertices that do not move, as a client names them: elements, from 0, of the POSITION accessor of
/// a triangle primitive. Without a mesh: of the only POSITION accessor there is, or of a Draco
/// mesh.
struct FixedVertices {
  struct Place {
    std::size_t mesh = 0;
    std::size_t primitive = 0;
  };
  std::optional<Place> place;
  std::vector<Index> vertices;
};

/// Most fixed vertices of a request, all lists together.
inline constexpr std::size_t kMostFixedVertices = 100'000;
/// Most entries of each list of a MeshSelection.
inline constexpr std::size_t kMostSelected = 10'000;

/// The meshes of a scene that are denoised: those listed and those of the nodes listed. Both lists
/// empty: all.
struct MeshSelection {
  std::vector<Index> meshes;
  std::vector<Index> nodes;  ///< their own meshes, not their children's

  bool all() const { return meshes.empty() && nodes.empty(); }
};

/// Takes "fixed_vertices" from a parameter document: one without a place, or any number with one.
std::vector<FixedVertices> read_fixed_vertices(ObjectReader& reader);
/// Takes "meshes" and "nodes"; a list that is given must not be empty.
MeshSelection read_selection(ObjectReader& reader);

/// Puts the same keys into a parameter document: a selection only where there is one.
void add_fixed_vertices(const std::vector<FixedVertices>& fixed, Json& document);
void add_selection(const MeshSelection& selection, Json& document);

}  // namespace fairway
