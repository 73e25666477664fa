// Results into the DOM. Accessors are never written in place: others may share them. The exception
// are the labels of Draco data, which hold no bytes and name one primitive only.

#include "proto/formats/gltf_patch.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "proto/formats/gltf_draco_patch.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_references.h"
#include "proto/formats/gltf_tangents.h"
#include "proto/formats/surface_result.h"

namespace fairway {
namespace {

constexpr std::string_view kIndices = "indices";
constexpr const char* kColors = "COLOR_0";

/// Bounds are stated where they were.
Bounds bounds_of(const Json& accessor) {
  const bool had = accessor.contains("min") || accessor.contains("max");
  return had ? Bounds::stated : Bounds::left_out;
}

/// How a primitive is written. `untouched` is a Draco stream that stays, beside new attributes.
enum class PrimitiveCoding { plain, draco, meshopt, untouched };

/// Patches the primitives of one surface.
class SurfacePatch {
 public:
  SurfacePatch(const DracoPatchSource& from, Compression compression, GltfOutput& output)
      : from_(from),
        tables_(from.tables),
        draco_(from.draco),
        plan_(from.plan),
        result_(from.result),
        references_(from.references),
        compression_(compression),
        output_(output) {}

  Result<void> run() {
    for (const SurfacePrimitive& primitive : plan_.primitives) {
      if (auto done = patch(primitive); !done) return done;
    }
    return {};
  }

  /// The primitives that were compressed with Draco, and those that could not be.
  std::size_t compressed() const { return compressed_; }
  std::size_t left_plain() const { return left_plain_; }

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
  Result<void> add_colors(const SurfacePrimitive& primitive);
  PrimitiveCoding wanted_coding(const SurfacePrimitive& primitive) const;
  bool can_be_draco(const SurfacePrimitive& primitive) const;
  PrimitiveCoding coding_of(const SurfacePrimitive& primitive);
  void uncompress_replaced(const SurfacePrimitive& primitive);
  template <class Make>
  Result<void> place(const Slot& slot, const Make& make, const SurfacePrimitive& primitive,
                     std::string_view name);
  std::optional<std::size_t> label_of(const SurfacePrimitive& primitive,
                                      std::string_view name) const;

  const DracoPatchSource& from_;
  const GltfTables& tables_;
  const DracoMeshes& draco_;
  const SurfacePlan& plan_;
  const SurfaceResult& result_;
  const std::vector<std::size_t>& references_;
  Compression compression_;
  GltfOutput& output_;
  std::map<Key, std::size_t> made_;
  ViewCoding coding_ = ViewCoding::plain;  ///< of the views of the primitive at hand
  std::size_t compressed_ = 0;
  std::size_t left_plain_ = 0;
};

/// Points "indices" or the attribute `name` of a primitive to the accessor of a slot. Only its
/// first primitive has the values made. No reference into the DOM outlives a new accessor, for
/// which the DOM may have to move: a document may come without "bufferViews".
template <class Make>
Result<void> SurfacePatch::place(const Slot& slot, const Make& make,
                                 const SurfacePrimitive& primitive, std::string_view name) {
  const auto [found, is_new] = made_.try_emplace(slot.key, 0);
  if (is_new) {
    Result<PackedValues> values = make();
    if (!values) return values.error();
    const ViewUse use{slot.target, slot.bounds, coding_};
    if (slot.label && references_[*slot.label] == 1) {
      found->second = *slot.label;
      output_.fill_accessor(*slot.label, *std::move(values), use);
    } else {
      found->second = output_.add_accessor(*std::move(values), use);
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
    const bool replaced = (result_.moved && (name == "POSITION" || name == "NORMAL")) ||
                          (name == kColors && result_.colors_vertices(true));
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

Result<void> SurfacePatch::straighten_tangents(const SurfacePrimitive& primitive) {
  const auto accessor = primitive.source.attribute("TANGENT");
  const VertexBlock& block = plan_.blocks[primitive.block];
  if (!accessor || !block.normal || !tables_.accessors[*accessor].is_vector(4)) return {};
  const auto make = [&] {
    return straight_tangents(tables_, draco_, primitive.source, *accessor,
                             std::span(result_.normals).subspan(block.first, block.count));
  };
  return place({{*accessor, primitive.block, "straight"}}, make, primitive, "TANGENT");
}

Result<void> SurfacePatch::add_attributes(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  for (const VertexAttribute& attribute : result_.attributes) {
    const auto make = [&]() -> Result<PackedValues> {
      const auto components = static_cast<std::size_t>(attribute.components);
      const auto values =
          std::span(attribute.values).subspan(block.first * components, block.count * components);
      return borrow_floats(values, attribute.components);
    };
    const Slot slot{{block.position, block.draco_view.value_or(kNoIndex), attribute.name}};
    if (auto done = place(slot, make, primitive, attribute.name); !done) return done;
  }
  return add_colors(primitive);
}

Result<void> SurfacePatch::add_colors(const SurfacePrimitive& primitive) {
  const VertexBlock& block = plan_.blocks[primitive.block];
  const auto old = primitive.source.attribute(kColors);
  if (!result_.colors_vertices(old.has_value())) return {};
  const auto make = [&]() -> Result<PackedValues> {
    return pack_linear_colors(std::span(result_.colors->values).subspan(block.first, block.count));
  };
  const Slot slot{{block.position, block.draco_view.value_or(kNoIndex), kColors},
                  label_of(primitive, kColors)};
  return place(slot, make, primitive, kColors);
}

/// What is asked for, before it is known whether it can be done.
PrimitiveCoding SurfacePatch::wanted_coding(const SurfacePrimitive& primitive) const {
  switch (compression_) {
    case Compression::none:
      return PrimitiveCoding::plain;
    case Compression::draco:
      return PrimitiveCoding::draco;
    case Compression::meshopt:
      return PrimitiveCoding::meshopt;
    case Compression::keep:
      break;
  }
  if (primitive.source.draco) {
    return result_.moved ? PrimitiveCoding::draco : PrimitiveCoding::untouched;
  }
  const auto view = tables_.accessors[primitive.source.position()].view;
  const bool compressed = view && tables_.views[*view].compression;
  return compressed ? PrimitiveCoding::meshopt : PrimitiveCoding::plain;
}

/// A Draco stream is a list of triangles by index, so that strips, fans and what has no indices
/// would become something else; and it holds all vertices of its primitive: those that others draw
/// from too would be stored once for each, and those that nothing draws from may be too many.
bool SurfacePatch::can_be_draco(const SurfacePrimitive& primitive) const {
  const TriangleSource& source = primitive.source;
  const bool list = source.mode == PrimitiveMode::triangles && source.indices.has_value();
  const auto users =
      std::count_if(plan_.primitives.begin(), plan_.primitives.end(),
                    [&](const SurfacePrimitive& p) { return p.block == primitive.block; });
  return users == 1 && primitive.triangles > 0 && (list || source.draco) &&
         draco_keeps_points(plan_.blocks[primitive.block].count, primitive.triangles);
}

PrimitiveCoding SurfacePatch::coding_of(const SurfacePrimitive& primitive) {
  const PrimitiveCoding wanted = wanted_coding(primitive);
  if (wanted != PrimitiveCoding::draco || can_be_draco(primitive)) return wanted;
  ++left_plain_;
  return PrimitiveCoding::plain;
}

/// Attributes that are replaced stand no longer in the stream that stays.
void SurfacePatch::uncompress_replaced(const SurfacePrimitive& primitive) {
  Json& stream = json_of(primitive)["extensions"][kDracoExtension]["attributes"];
  for (const VertexAttribute& attribute : result_.attributes) stream.erase(attribute.name);
  if (result_.colors_vertices(true)) stream.erase(kColors);
}

Result<void> SurfacePatch::patch(const SurfacePrimitive& primitive) {
  const PrimitiveCoding coding = coding_of(primitive);
  if (coding == PrimitiveCoding::draco) {
    ++compressed_;
    return compress_primitive(from_, primitive, output_);
  }
  coding_ = coding == PrimitiveCoding::meshopt ? ViewCoding::meshopt : ViewCoding::plain;
  if (coding == PrimitiveCoding::untouched) {
    uncompress_replaced(primitive);
  } else if (primitive.source.draco) {
    if (auto done = unpack_draco(primitive); !done) return done;
  }
  if (result_.moved) {
    if (auto done = move(primitive); !done) return done;
    if (auto done = straighten_tangents(primitive); !done) return done;
  }
  return add_attributes(primitive);
}

bool may_write_draco(Compression compression, const SurfacePlan& plan) {
  return compression == Compression::draco ||
         (compression == Compression::keep &&
          std::any_of(plan.primitives.begin(), plan.primitives.end(),
                      [](const SurfacePrimitive& p) { return p.source.draco.has_value(); }));
}

}  // namespace

Result<std::vector<std::string>> patch_surfaces(const GltfTables& tables, const GltfLayout& layout,
                                                std::span<const Surface> surfaces,
                                                std::span<const SurfaceResult> results,
                                                const Encoding& encoding, GltfOutput& output) {
  if (auto done = check_results(surfaces, results); !done) return done.error();
  const std::vector<std::size_t> references =
      accessor_references(output.json(), tables.accessors.size());
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const SurfaceResult& result = results[i];
    if (result.untouched) continue;
    SurfaceGrids grids;
    if (may_write_draco(encoding.compression, layout.plans[i])) {
      grids = make_surface_grids(result.moved ? result.positions : surfaces[i].mesh.positions,
                                 result.attributes, encoding.draco);
    }
    const DracoPatchSource from{tables, layout.draco_meshes, layout.plans[i], surfaces[i], result,
                                grids,  encoding.draco,      references};
    SurfacePatch patch(from, encoding.compression, output);
    if (auto done = patch.run(); !done) return done.error();
    if (patch.compressed() > 0) {
      notes.push_back(describe_surface(surfaces[i].name, grids, result.attributes));
    }
    if (patch.left_plain() > 0) {
      notes.push_back(
          fmt::format("{}: {} primitives are not compressed with Draco, which holds lists of "
                      "triangles with indices and vertices of their own",
                      surfaces[i].name, patch.left_plain()));
    }
  }
  if (!layout.draco_meshes.empty()) forget_unused_draco(output.json());
  return notes;
}

}  // namespace fairway
