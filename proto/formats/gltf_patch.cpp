// Results into the DOM. Accessors are never written in place: others may share them. The exception
// are the labels of Draco data, which hold no bytes and name one primitive only.

#include "proto/formats/gltf_patch.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "proto/formats/gltf_accessor.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_references.h"

namespace fairway {
namespace {

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
    for (const Vec3& position : result.positions) {
      if (!position.cast<float>().allFinite()) {
        return Error{ErrorCode::diverged,
                     "A position left the range of single precision; use fewer or smaller steps."};
      }
    }
  }
  for (const VertexAttribute& attribute : result.attributes) {
    if (attribute.components < 1 || attribute.components > 4 ||
        attribute.values.size() != vertices * static_cast<std::size_t>(attribute.components)) {
      return unfit(surface, attribute.name);
    }
  }
  return {};
}

/// The tangent of glTF (w is the handedness) made perpendicular to a new normal.
void straighten(const Vec3& normal, double* tangent) {
  Vec3 t(tangent[0], tangent[1], tangent[2]);
  t -= normal * normal.dot(t);
  if (!(t.norm() > 1e-12)) {
    Eigen::Index smallest = 0;
    normal.cwiseAbs().minCoeff(&smallest);
    t = normal.cross(Vec3::Unit(smallest));
  }
  if (!(t.norm() > 0.0)) t = Vec3::UnitX();
  t.normalize();
  for (int c = 0; c < 3; ++c) tangent[c] = t[c];
}

/// Patches the primitives of one surface.
class SurfacePatch {
 public:
  SurfacePatch(const GltfTables& tables, const DracoMeshes& draco, const SurfacePlan& plan,
               const SurfaceResult& result, const std::vector<std::size_t>& references,
               GltfOutput& output)
      : tables_(tables),
        draco_(draco),
        plan_(plan),
        result_(result),
        references_(references),
        output_(output) {}

  Result<void> run() {
    for (const SurfacePrimitive& primitive : plan_.primitives) {
      if (auto done = patch(primitive); !done) return done;
    }
    return {};
  }

 private:
  /// What an accessor was made from: an accessor, or an attribute's place in the result; the block;
  /// and what for.
  using Key = std::tuple<std::size_t, std::size_t, std::string>;

  Json& json_of(const SurfacePrimitive& primitive) {
    return output_.json()["meshes"][plan_.mesh]["primitives"][primitive.index];
  }

  Result<void> patch(const SurfacePrimitive& primitive);
  Result<void> unpack_draco(const SurfacePrimitive& primitive);
  void move(const SurfacePrimitive& primitive);
  Result<void> straighten_tangents(const SurfacePrimitive& primitive, std::size_t accessor);
  void add_attributes(const SurfacePrimitive& primitive);
  std::size_t place(const Key& key, std::optional<std::size_t> label, const PackedValues& values,
                    ViewTarget target, Bounds bounds);
  std::optional<std::size_t> label_of(const SurfacePrimitive& primitive,
                                      std::string_view name) const;

  const GltfTables& tables_;
  const DracoMeshes& draco_;
  const SurfacePlan& plan_;
  const SurfaceResult& result_;
  const std::vector<std::size_t>& references_;
  GltfOutput& output_;
  std::map<Key, std::size_t> made_;
};

/// The accessor made for `key`, now or before. A `label` that only this primitive names is filled.
std::size_t SurfacePatch::place(const Key& key, std::optional<std::size_t> label,
                                const PackedValues& values, ViewTarget target, Bounds bounds) {
  const auto found = made_.find(key);
  if (found != made_.end()) return found->second;
  std::size_t index = 0;
  if (label && references_[*label] == 1) {
    index = *label;
    output_.fill_accessor(index, values, target, bounds);
  } else {
    index = output_.add_accessor(values, target, bounds);
  }
  made_.emplace(key, index);
  return index;
}

/// The accessor that labels a compressed attribute, if it is one.
std::optional<std::size_t> SurfacePatch::label_of(const SurfacePrimitive& primitive,
                                                  std::string_view name) const {
  const auto& draco = primitive.source.draco;
  if (!draco || !draco->ids.contains(name)) return std::nullopt;
  return primitive.source.attribute(name);
}

Result<void> SurfacePatch::unpack_draco(const SurfacePrimitive& primitive) {
  const DracoUse& use = *primitive.source.draco;
  const DracoMesh& mesh = draco_.at(use.view);
  Json& json = json_of(primitive);
  for (const auto& [name, id] : use.ids) {
    const auto accessor = primitive.source.attribute(name);
    const bool replaced = result_.moved && (name == "POSITION" || name == "NORMAL");
    if (!accessor || replaced) continue;
    const GltfAccessor& label = tables_.accessors[*accessor];
    const auto values = pack_draco(mesh, *mesh.find_unique(id), label);
    if (!values) return values.error();
    const Json& def = output_.json()["accessors"][*accessor];
    const bool bounds = name == "POSITION" || def.contains("min") || def.contains("max");
    json["attributes"][name] =
        place({*accessor, primitive.block, name}, accessor, *values, ViewTarget::vertices, bounds);
  }
  const auto indices = primitive.source.indices;
  const PackedValues packed =
      pack_triangles(mesh.triangles(), mesh.point_count(),
                     indices ? tables_.accessors[*indices].type : ComponentType::u16);
  json["indices"] =
      place({indices.value_or(kNoIndex), primitive.block, "indices"}, indices, packed,
            ViewTarget::indices, indices && output_.json()["accessors"][*indices].contains("max"));
  if (primitive.source.mode != PrimitiveMode::triangles) json["mode"] = 4;
  json["extensions"].erase(kDracoExtension);
  if (json["extensions"].empty()) json.erase("extensions");
  return {};
}

void SurfacePatch::move(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  Json& attributes = json_of(primitive)["attributes"];
  // Blocks that share the POSITION accessor hold the same places, so they share the new one too.
  attributes["POSITION"] =
      place({block.position, block.draco_view.value_or(kNoIndex), "POSITION"},
            label_of(primitive, "POSITION"),
            pack_vectors(std::span(result_.positions).subspan(block.first, block.count)),
            ViewTarget::vertices, true);
  if (!block.normal) return;
  attributes["NORMAL"] =
      place({*block.normal, primitive.block, "NORMAL"}, label_of(primitive, "NORMAL"),
            pack_vectors(std::span(result_.normals).subspan(block.first, block.count)),
            ViewTarget::vertices, false);
}

Result<void> SurfacePatch::straighten_tangents(const SurfacePrimitive& primitive,
                                               std::size_t accessor) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  const GltfAccessor& from = tables_.accessors[accessor];
  if (!from.is_vector(4)) return {};
  const bool compressed = label_of(primitive, "TANGENT").has_value();
  auto tangents = [&]() -> Result<std::vector<double>> {
    if (!compressed) return read_values(tables_, accessor);
    const DracoMesh& mesh = draco_.at(primitive.source.draco->view);
    const std::uint64_t id = primitive.source.draco->ids.find("TANGENT")->second;
    return draco_values(mesh, *mesh.find_unique(id), from);
  }();
  if (!tangents) return tangents.error();
  for (std::size_t i = 0; i < block.count; ++i) {
    straighten(result_.normals[block.first + i], tangents->data() + 4 * i);
  }
  json_of(primitive)["attributes"]["TANGENT"] =
      place({accessor, primitive.block, "straight"}, std::nullopt,
            pack_values(*tangents, {ComponentType::f32, false, 4}), ViewTarget::vertices, false);
  return {};
}

void SurfacePatch::add_attributes(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  Json& attributes = json_of(primitive)["attributes"];
  for (const VertexAttribute& attribute : result_.attributes) {
    const auto components = static_cast<std::size_t>(attribute.components);
    const auto values =
        std::span(attribute.values).subspan(block.first * components, block.count * components);
    attributes[attribute.name] =
        place({block.position, block.draco_view.value_or(kNoIndex), attribute.name}, std::nullopt,
              pack_floats(values, attribute.components), ViewTarget::vertices, false);
  }
}

Result<void> SurfacePatch::patch(const SurfacePrimitive& primitive) {
  if (primitive.source.draco) {
    if (auto done = unpack_draco(primitive); !done) return done;
  }
  if (result_.moved) {
    move(primitive);
    const auto tangent = primitive.source.attribute("TANGENT");
    if (tangent && plan_.blocks[primitive.block].normal) {
      if (auto done = straighten_tangents(primitive, *tangent); !done) return done;
    }
  }
  add_attributes(primitive);
  return {};
}

}  // namespace

Result<void> patch_surfaces(const GltfTables& tables, const GltfLayout& layout,
                            std::span<const Surface> surfaces,
                            std::span<const SurfaceResult> results, GltfOutput& output) {
  if (results.size() != surfaces.size() || layout.plans.size() != surfaces.size()) {
    return Error{ErrorCode::internal, "There is not one result per surface."};
  }
  const std::vector<std::size_t> references =
      accessor_references(output.json(), tables.accessors.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (auto done = check_result(surfaces[i], results[i]); !done) return done;
    SurfacePatch patch(tables, layout.draco_meshes, layout.plans[i], results[i], references,
                       output);
    if (auto done = patch.run(); !done) return done;
  }
  if (!layout.draco_meshes.empty()) forget_unused_draco(output.json());
  return {};
}

}  // namespace fairway
