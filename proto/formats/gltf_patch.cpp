// Results into the DOM. Accessors are never written in place: others may share them. The exception
// are the labels of Draco data, which hold no bytes and name one primitive only.

#include "proto/formats/gltf_patch.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "proto/formats/gltf_accessor.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_references.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

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

constexpr std::string_view kIndices = "indices";

/// Bounds are stated where they were.
Bounds bounds_of(const Json& accessor) {
  const bool had = accessor.contains("min") || accessor.contains("max");
  return had ? Bounds::stated : Bounds::left_out;
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

  /// An accessor to be made, once per key. A `label` that only this primitive names is filled.
  struct Slot {
    Key key;
    std::optional<std::size_t> label = {};
    ViewTarget target = ViewTarget::vertices;
    Bounds bounds = Bounds::left_out;
  };

  Result<void> patch(const SurfacePrimitive& primitive);
  Result<void> unpack_draco(const SurfacePrimitive& primitive);
  Result<void> unpack_indices(const SurfacePrimitive& primitive);
  Result<void> move(const SurfacePrimitive& primitive);
  Result<void> straighten_tangents(const SurfacePrimitive& primitive);
  Result<void> add_attributes(const SurfacePrimitive& primitive);
  Result<PackedValues> straight_tangents(const SurfacePrimitive& primitive,
                                         std::size_t accessor) const;
  template <class Make>
  Result<void> place(const Slot& slot, const Make& make, const SurfacePrimitive& primitive,
                     std::string_view name);
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

/// Points "indices" or the attribute `name` of a primitive to the accessor of a slot. Only its
/// first primitive has the values made. No reference into the DOM outlives a new accessor, for
/// which the DOM may have to move: a document may come without "bufferViews".
template <class Make>
Result<void> SurfacePatch::place(const Slot& slot, const Make& make,
                                 const SurfacePrimitive& primitive, std::string_view name) {
  const auto [found, is_new] = made_.try_emplace(slot.key, 0);
  if (is_new) {
    const Result<PackedValues> values = make();
    if (!values) return values.error();
    if (slot.label && references_[*slot.label] == 1) {
      found->second = *slot.label;
      output_.fill_accessor(*slot.label, *values, slot.target, slot.bounds);
    } else {
      found->second = output_.add_accessor(*values, slot.target, slot.bounds);
    }
  }
  Json& json = json_of(primitive);
  (name == kIndices ? json[name] : json["attributes"][name]) = found->second;
  return {};
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
  for (const auto& [name, id] : use.ids) {
    const auto accessor = primitive.source.attribute(name);
    const bool replaced = result_.moved && (name == "POSITION" || name == "NORMAL");
    if (!accessor || replaced) continue;
    Slot slot{{*accessor, primitive.block, name}, accessor};
    slot.bounds =
        name == "POSITION" ? Bounds::stated : bounds_of(output_.json()["accessors"][*accessor]);
    const DracoAttribute& attribute = *mesh.find_unique(id);
    const auto make = [&] { return pack_draco(mesh, attribute, tables_.accessors[*accessor]); };
    if (auto done = place(slot, make, primitive, name); !done) return done;
  }
  if (auto done = unpack_indices(primitive); !done) return done;
  Json& json = json_of(primitive);
  if (primitive.source.mode != PrimitiveMode::triangles) json["mode"] = 4;
  json["extensions"].erase(kDracoExtension);
  if (json["extensions"].empty()) json.erase("extensions");
  return {};
}

Result<void> SurfacePatch::unpack_indices(const SurfacePrimitive& primitive) {
  const DracoMesh& mesh = draco_.at(primitive.source.draco->view);
  const auto indices = primitive.source.indices;
  Slot slot{{indices.value_or(kNoIndex), primitive.block, "indices"}, indices, ViewTarget::indices};
  if (indices) slot.bounds = bounds_of(output_.json()["accessors"][*indices]);
  const auto make = [&]() -> Result<PackedValues> {
    return pack_triangles(mesh.triangles(), mesh.point_count(),
                          indices ? tables_.accessors[*indices].type : ComponentType::u16);
  };
  return place(slot, make, primitive, kIndices);
}

Result<void> SurfacePatch::move(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  // Blocks that share the POSITION accessor hold the same places, so they share the new one too.
  const Slot position{{block.position, block.draco_view.value_or(kNoIndex), "POSITION"},
                      label_of(primitive, "POSITION"),
                      ViewTarget::vertices,
                      Bounds::stated};
  const auto make_position = [&]() -> Result<PackedValues> {
    return pack_vectors(std::span(result_.positions).subspan(block.first, block.count));
  };
  auto done = place(position, make_position, primitive, "POSITION");
  if (!done || !block.normal) return done;
  const Slot normal{{*block.normal, primitive.block, "NORMAL"}, label_of(primitive, "NORMAL")};
  const auto make_normal = [&]() -> Result<PackedValues> {
    return pack_vectors(std::span(result_.normals).subspan(block.first, block.count));
  };
  return place(normal, make_normal, primitive, "NORMAL");
}

Result<PackedValues> SurfacePatch::straight_tangents(const SurfacePrimitive& primitive,
                                                     std::size_t accessor) const {
  const VertexBlock& block = plan_.blocks[primitive.block];
  const bool compressed = label_of(primitive, "TANGENT").has_value();
  auto tangents = [&]() -> Result<std::vector<double>> {
    if (!compressed) return read_values(tables_, accessor);
    const DracoMesh& mesh = draco_.at(primitive.source.draco->view);
    const std::uint64_t id = primitive.source.draco->ids.find("TANGENT")->second;
    return draco_values(mesh, *mesh.find_unique(id), tables_.accessors[accessor]);
  }();
  if (!tangents) return tangents.error();
  for (std::size_t i = 0; i < block.count; ++i) {
    straighten(result_.normals[block.first + i], tangents->data() + 4 * i);
  }
  return pack_values(*tangents, {ComponentType::f32, false, 4});
}

Result<void> SurfacePatch::straighten_tangents(const SurfacePrimitive& primitive) {
  const auto accessor = primitive.source.attribute("TANGENT");
  if (!accessor || !plan_.blocks[primitive.block].normal ||
      !tables_.accessors[*accessor].is_vector(4)) {
    return {};
  }
  const auto make = [&] { return straight_tangents(primitive, *accessor); };
  return place({{*accessor, primitive.block, "straight"}}, make, primitive, "TANGENT");
}

Result<void> SurfacePatch::add_attributes(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  for (const VertexAttribute& attribute : result_.attributes) {
    const auto make = [&]() -> Result<PackedValues> {
      const auto components = static_cast<std::size_t>(attribute.components);
      const auto values =
          std::span(attribute.values).subspan(block.first * components, block.count * components);
      return pack_floats(values, attribute.components);
    };
    const Slot slot{{block.position, block.draco_view.value_or(kNoIndex), attribute.name}};
    if (auto done = place(slot, make, primitive, attribute.name); !done) return done;
  }
  return {};
}

Result<void> SurfacePatch::patch(const SurfacePrimitive& primitive) {
  if (primitive.source.draco) {
    if (auto done = unpack_draco(primitive); !done) return done;
  }
  if (result_.moved) {
    if (auto done = move(primitive); !done) return done;
    if (auto done = straighten_tangents(primitive); !done) return done;
  }
  return add_attributes(primitive);
}

}  // namespace

Result<void> patch_surfaces(const GltfTables& tables, const GltfLayout& layout,
                            std::span<const Surface> surfaces,
                            std::span<const SurfaceResult> results, GltfOutput& output) {
  if (auto done = check_results(surfaces, results); !done) return done;
  const std::vector<std::size_t> references =
      accessor_references(output.json(), tables.accessors.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    SurfacePatch patch(tables, layout.draco_meshes, layout.plans[i], results[i], references,
                       output);
    if (auto done = patch.run(); !done) return done;
  }
  if (!layout.draco_meshes.empty()) forget_unused_draco(output.json());
  return {};
}

}  // namespace fairway
