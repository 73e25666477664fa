// Which parts of a file are meant, as a part of the parameter document.

#include "proto/messages/part_selection.h"

#include <string_view>
#include <utility>

namespace fairway {
namespace {

FixedVertices read_fixed_at_place(ObjectReader& reader, std::size_t most) {
  constexpr int kLast = 1'000'000'000;
  int mesh = 0;
  int primitive = 0;
  FixedVertices fixed;
  reader.require("mesh");
  reader.integer("mesh", 0, kLast, mesh);
  reader.integer("primitive", 0, kLast, primitive);
  reader.require("vertices");
  reader.indices("vertices", {0, most}, fixed.vertices);
  fixed.place = {static_cast<std::size_t>(mesh), static_cast<std::size_t>(primitive)};
  return fixed;
}

Json fixed_vertices_document(const std::vector<FixedVertices>& fixed) {
  if (fixed.size() == 1 && !fixed.front().place) return fixed.front().vertices;
  Json list = Json::array();
  for (const FixedVertices& item : fixed) {
    list.push_back({{"mesh", item.place->mesh},
                    {"primitive", item.place->primitive},
                    {"vertices", item.vertices}});
  }
  return list;
}

std::vector<Index> read_list(ObjectReader& reader, std::string_view key) {
  std::vector<Index> out;
  reader.indices(key, {1, kMostSelected}, out);
  return out;
}

}  // namespace

std::vector<FixedVertices> read_fixed_vertices(ObjectReader& reader) {
  constexpr std::string_view kKey = "fixed_vertices";
  std::vector<FixedVertices> out;
  std::size_t left = kMostFixedVertices;
  const auto read = [&](ObjectReader& item) {
    out.push_back(read_fixed_at_place(item, left));
    left -= out.back().vertices.size();
  };
  reader.objects_or(kKey, read, [&] {
    FixedVertices fixed;
    reader.indices(kKey, {0, kMostFixedVertices}, fixed.vertices);
    if (!fixed.vertices.empty()) out.push_back(std::move(fixed));
  });
  return out;
}

MeshSelection read_selection(ObjectReader& reader) {
  MeshSelection selection;
  selection.meshes = read_list(reader, "meshes");
  selection.nodes = read_list(reader, "nodes");
  return selection;
}

void add_fixed_vertices(const std::vector<FixedVertices>& fixed, Json& document) {
  document["fixed_vertices"] = fixed_vertices_document(fixed);
}

void add_selection(const MeshSelection& selection, Json& document) {
  if (!selection.meshes.empty()) document["meshes"] = selection.meshes;
  if (!selection.nodes.empty()) document["nodes"] = selection.nodes;
}

}  // namespace fairway
