// Triangle primitives of an untrusted glTF. Source: glTF 2.0 section 3.7.2.

#include "proto/formats/gltf_primitive.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "proto/formats/gltf_accessor.h"

namespace fairway {
namespace {

constexpr std::uint64_t kLastMode = 6;
/// More than any renderer takes. Members of an object are found one by one, so that without a limit
/// one primitive could cost minutes.
constexpr std::size_t kMaxAttributes = 256;

Result<void> check_attribute_count(const JsonPlace& attributes) {
  if (attributes.size() <= kMaxAttributes) return {};
  return attributes.error(fmt::format("{} attributes are stated, {} are read; leave some out.",
                                      attributes.size(), kMaxAttributes));
}

Result<std::map<std::string, std::size_t, std::less<>>> read_attributes(const JsonPlace& primitive,
                                                                        const GltfTables& tables) {
  const auto attributes = primitive.object("attributes");
  if (!attributes) return attributes.error();
  if (!*attributes) return primitive.error("\"attributes\" is missing.");
  if (auto done = check_attribute_count(**attributes); !done) return done.error();
  std::map<std::string, std::size_t, std::less<>> out;
  for (const auto& item : (*attributes)->json().items()) {
    const auto accessor = (*attributes)->required_index(item.key(), tables.accessors.size());
    if (!accessor) return accessor.error();
    out.emplace(item.key(), *accessor);
  }
  return out;
}

/// All attributes of a primitive have one element per vertex. Draco's accessors are only labels.
Result<void> check_counts(const JsonPlace& primitive, const TriangleSource& source,
                          const GltfTables& tables) {
  const std::uint64_t vertices = tables.accessors[source.position()].count;
  for (const auto& [name, accessor] : source.attributes) {
    const bool compressed = source.draco && source.draco->ids.contains(name);
    if (!compressed && tables.accessors[accessor].count != vertices) {
      return primitive.error("its attributes have different numbers of elements.");
    }
  }
  return {};
}

Result<void> check_targets(const JsonPlace& primitive, const GltfTables& tables) {
  const auto targets = primitive.array("targets");
  if (!targets) return targets.error();
  for (std::size_t i = 0; *targets && i < (*targets)->size(); ++i) {
    const JsonPlace target = (**targets)[i];
    if (!target.json().is_object()) return target.error("this must be an object.");
    if (auto done = check_attribute_count(target); !done) return done;
    for (const auto& item : target.json().items()) {
      const auto accessor = target.required_index(item.key(), tables.accessors.size());
      if (!accessor) return accessor.error();
    }
  }
  return {};
}

/// Every index names a vertex.
Result<void> check_range(const JsonPlace& primitive, std::span<const Index> indices,
                         Index vertices) {
  // The sign bits of i and of v − 1 − i, without a branch: below 2³¹ both are 0 where 0 ≤ i < v.
  constexpr Index kSign = Index{1} << 31U;
  Index signs = 0;
  for (const Index index : indices) signs |= index | (vertices - 1 - index);
  if (vertices <= kSign && (signs & kSign) == 0) return {};
  if (indices.empty()) return {};
  const Index largest = *std::max_element(indices.begin(), indices.end());
  if (largest < vertices) return {};
  const auto at = std::find(indices.begin(), indices.end(), largest) - indices.begin();
  return primitive.error_at("indices",
                            fmt::format("index {} at {} of {} vertices.", largest, at, vertices));
}

Result<std::vector<Index>> index_list(const JsonPlace& primitive, const TriangleSource& source,
                                      Index vertices, const GltfTables& tables) {
  std::vector<Index> out;
  if (!source.indices) {
    out.resize(vertices);
    std::iota(out.begin(), out.end(), Index{0});
    return out;
  }
  auto indices = read_indices(tables, *source.indices);
  if (!indices) return indices.error();
  if (auto done = check_range(primitive, *indices, vertices); !done) return done.error();
  return indices;
}

std::vector<Triangle> join(PrimitiveMode mode, const std::vector<Index>& list) {
  std::vector<Triangle> out;
  const std::size_t step = mode == PrimitiveMode::triangles ? 3 : 1;
  out.reserve((list.size() - 2 + step - 1) / step);
  for (std::size_t i = 0; i + 2 < list.size(); i += step) {
    if (mode == PrimitiveMode::fan) {
      out.push_back({list[0], list[i + 1], list[i + 2]});
    } else if (mode == PrimitiveMode::strip && i % 2 == 1) {
      out.push_back({list[i + 1], list[i], list[i + 2]});
    } else {
      out.push_back({list[i], list[i + 1], list[i + 2]});
    }
  }
  return out;
}

}  // namespace

std::optional<std::size_t> TriangleSource::attribute(std::string_view name) const {
  const auto it = attributes.find(name);
  if (it == attributes.end()) return std::nullopt;
  return it->second;
}

Result<std::optional<TriangleSource>> read_primitive(const JsonPlace& primitive,
                                                     const GltfTables& tables) {
  if (!primitive.json().is_object()) return primitive.error("this must be an object.");
  const auto mode =
      primitive.count_or("mode", static_cast<std::uint64_t>(PrimitiveMode::triangles));
  if (!mode) return mode.error();
  if (*mode > kLastMode) return primitive.error_at("mode", "there is no such mode.");
  TriangleSource source;
  source.mode = static_cast<PrimitiveMode>(*mode);
  auto attributes = read_attributes(primitive, tables);
  if (!attributes) return attributes.error();
  source.attributes = *std::move(attributes);
  const auto indices = primitive.index("indices", tables.accessors.size());
  if (!indices) return indices.error();
  source.indices = *indices;
  auto draco = read_draco_use(primitive, tables);
  if (!draco) return draco.error();
  source.draco = *std::move(draco);
  if (const auto done = check_targets(primitive, tables); !done) return done.error();
  if (*mode < static_cast<std::uint64_t>(PrimitiveMode::triangles)) {
    if (source.draco) return primitive.error("only triangles can be compressed with Draco.");
    return std::optional<TriangleSource>();
  }
  // A primitive without POSITION draws nothing.
  if (!source.attributes.contains("POSITION")) return std::optional<TriangleSource>();
  if (const auto done = check_counts(primitive, source, tables); !done) return done.error();
  return std::optional<TriangleSource>(std::move(source));
}

Result<Index> vertex_count(const JsonPlace& primitive, const TriangleSource& source,
                           const GltfTables& tables, const DracoMeshes& meshes) {
  const std::uint64_t count = tables.accessors[source.position()].count;
  if (count >= kNoIndex) return primitive.error("it has more vertices than an index can name.");
  if (source.draco) {
    const DracoMesh& mesh = meshes.at(source.draco->view);
    if (count != mesh.point_count()) {
      return primitive.error(fmt::format("its accessors state {} vertices, its Draco data has {}.",
                                         count, mesh.point_count()));
    }
    const std::uint64_t corners = mesh.triangles().size() * 3;
    if (source.indices && source.mode == PrimitiveMode::triangles &&
        tables.accessors[*source.indices].count != corners) {
      return primitive.error(fmt::format("its accessors state {} indices, its Draco data has {}.",
                                         tables.accessors[*source.indices].count, corners));
    }
  }
  return static_cast<Index>(count);
}

std::uint64_t triangle_estimate(const TriangleSource& source, const GltfTables& tables,
                                const DracoMeshes& meshes) {
  if (source.draco) return meshes.at(source.draco->view).triangles().size();
  const std::uint64_t corners =
      tables.accessors[source.indices ? *source.indices : source.position()].count;
  return source.mode == PrimitiveMode::triangles ? corners / 3 : corners;
}

Result<std::vector<Triangle>> read_triangles(const JsonPlace& primitive,
                                             const TriangleSource& source, Index vertices,
                                             const GltfTables& tables, const DracoMeshes& meshes) {
  if (source.draco) return meshes.at(source.draco->view).triangles();
  if (source.mode == PrimitiveMode::triangles && source.indices) {
    const std::uint64_t corners = tables.accessors[*source.indices].count;
    if (corners > 0 && corners % 3 == 0) {
      auto triangles = read_index_triples(tables, *source.indices);
      if (!triangles) return triangles.error();
      const std::span<const Index> indices(triangles->data()->data(), 3 * triangles->size());
      if (auto done = check_range(primitive, indices, vertices); !done) return done.error();
      return triangles;
    }
  }
  const auto list = index_list(primitive, source, vertices, tables);
  if (!list) return list.error();
  if (list->size() < 3) return primitive.error("a triangle has three vertices.");
  if (source.mode == PrimitiveMode::triangles && list->size() % 3 != 0) {
    return primitive.error(
        fmt::format("triangles take a multiple of three vertices, not {}.", list->size()));
  }
  return join(source.mode, *list);
}

}  // namespace fairway
