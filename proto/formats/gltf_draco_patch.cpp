// Primitives on their way into KHR_draco_mesh_compression.

#include "proto/formats/gltf_draco_patch.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "proto/formats/gltf_accessor.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_tangents.h"

namespace fairway {
namespace {

/// The shape and bounds of values, for their label.
PackedValues shape_of(const DracoPart& part, std::uint64_t count) {
  PackedValues out;
  out.components = part.components;
  out.count = count;
  if (const auto* packed = std::get_if<PackedValues>(&part.values)) {
    out.type = packed->type;
    out.normalized = packed->normalized;
    out.min = packed->min;
    out.max = packed->max;
  }
  return out;
}

class PrimitiveCompressor {
 public:
  PrimitiveCompressor(const DracoPatchSource& from, const SurfacePrimitive& primitive,
                      GltfOutput& output)
      : from_(from),
        primitive_(primitive),
        block_(from.plan.blocks[primitive.block]),
        output_(output) {}

  Result<void> run();

 private:
  Json& json() { return output_.json()["meshes"][from_.plan.mesh]["primitives"][primitive_.index]; }
  std::span<const Vec3> of_block(const std::vector<Vec3>& vectors) const {
    return std::span(vectors).subspan(block_.first, block_.count);
  }
  bool was_compressed(std::string_view name) const {
    return primitive_.source.draco && primitive_.source.draco->ids.contains(name);
  }
  bool has(std::string_view name) const {
    return std::any_of(names_.begin(), names_.end(),
                       [name](const std::string& known) { return known == name; });
  }
  void add(std::string name, DracoPart part);
  void add_packed(const std::string& name, PackedValues values);
  Result<void> add_moved();
  void add_new();
  Result<void> add_compressed();
  bool add_plain();
  bool order_is_free();
  std::size_t label(const std::string& name, const DracoPart& part, std::uint64_t count);
  void write(DracoStream stream);

  const DracoPatchSource& from_;
  const SurfacePrimitive& primitive_;
  const VertexBlock& block_;
  GltfOutput& output_;
  std::vector<std::string> names_;
  std::vector<DracoPart> parts_;
};

void PrimitiveCompressor::add(std::string name, DracoPart part) {
  // Names stand in the primitive; in the stream only unique ids are needed.
  part.name.clear();
  names_.push_back(std::move(name));
  parts_.push_back(std::move(part));
}

/// Texture coordinates and curvature of floats are rounded, all else is kept as it is.
void PrimitiveCompressor::add_packed(const std::string& name, PackedValues values) {
  DracoPart part{.kind = draco_kind_of(name),
                 .name = {},
                 .components = values.components,
                 .values = {},
                 .grid = gltf_grid(name, values, from_.options)};
  part.values = std::move(values);
  add(name, std::move(part));
}

Result<void> PrimitiveCompressor::add_moved() {
  const bool moved = from_.result.moved;
  add("POSITION",
      position_part(of_block(moved ? from_.result.positions : from_.surface.mesh.positions),
                    from_.grids.position));
  if (!block_.normal) return {};
  if (moved || was_compressed("NORMAL")) {
    add("NORMAL",
        normal_part(of_block(moved ? from_.result.normals : from_.surface.normals), from_.options));
  }
  const auto tangent = primitive_.source.attribute("TANGENT");
  if (!moved || !tangent || !from_.tables.accessors[*tangent].is_vector(4)) return {};
  auto tangents = straight_tangents(from_.tables, from_.draco, primitive_.source, *tangent,
                                    of_block(from_.result.normals));
  if (!tangents) return tangents.error();
  add_packed("TANGENT", *std::move(tangents));
  return {};
}

void PrimitiveCompressor::add_new() {
  for (std::size_t i = 0; i < from_.result.attributes.size(); ++i) {
    const VertexAttribute& attribute = from_.result.attributes[i];
    add(attribute.name,
        attribute_part(attribute, from_.grids.attributes[i], block_.first, block_.count));
  }
  if (!from_.result.colors_vertices(primitive_.source.attribute("COLOR_0").has_value())) return;
  add_packed("COLOR_0",
             pack_linear_colors(
                 std::span(from_.result.colors->values).subspan(block_.first, block_.count)));
}

/// What has to be taken out of the old stream.
Result<void> PrimitiveCompressor::add_compressed() {
  if (!primitive_.source.draco) return {};
  const DracoMesh& mesh = from_.draco.at(primitive_.source.draco->view);
  for (const auto& [name, id] : primitive_.source.draco->ids) {
    const auto accessor = primitive_.source.attribute(name);
    if (!accessor || has(name)) continue;
    auto values = pack_draco(mesh, *mesh.find_unique(id), from_.tables.accessors[*accessor]);
    if (!values) return values.error();
    add_packed(name, *std::move(values));
  }
  return {};
}

/// All that still stands beside the stream, so that it can be reordered too; false where some of
/// it cannot be read.
bool PrimitiveCompressor::add_plain() {
  for (const auto& [name, accessor] : primitive_.source.attributes) {
    if (has(name)) continue;
    const GltfAccessor& from = from_.tables.accessors[accessor];
    if (from.matrix) return false;
    const auto values = read_stored(from_.tables, accessor);
    if (!values) return false;
    add_packed(name, pack_values(*values, {from.type, from.normalized, from.components}));
  }
  return true;
}

/// Vertices are named by morph targets and by extensions of primitive and mesh.
bool PrimitiveCompressor::order_is_free() {
  if (from_.options.keep_order) return false;
  const Json& mesh = output_.json()["meshes"][from_.plan.mesh];
  const Json& primitive = json();
  if (mesh.contains("extensions") || primitive.contains("targets")) return false;
  const auto extensions = primitive.find("extensions");
  const bool others =
      extensions != primitive.end() &&
      extensions->size() > static_cast<std::size_t>(extensions->contains(kDracoExtension));
  return !others && add_plain();
}

/// The label of an attribute, with the bounds that a reader of the stream will find.
std::size_t PrimitiveCompressor::label(const std::string& name, const DracoPart& part,
                                       std::uint64_t count) {
  std::optional<std::size_t> old = primitive_.source.attribute(name);
  if (!was_compressed(name) || from_.references[*old] != 1) old.reset();
  PackedValues shape = shape_of(part, count);
  if (name != "POSITION") return output_.label(old, shape, Bounds::left_out);
  const ValueBounds bounds = value_bounds(std::get<std::span<const Vec3>>(part.values));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto stored = [&](float value) {
      return static_cast<double>(part.grid ? part.grid->rounded(value, c) : value);
    };
    shape.min.push_back(stored(bounds.low[c]));
    shape.max.push_back(stored(bounds.high[c]));
  }
  return output_.label(old, shape, Bounds::stated);
}

void PrimitiveCompressor::write(DracoStream stream) {
  const std::size_t view = output_.add_stream(std::move(stream.bytes));
  Json attributes = Json::object();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const std::size_t accessor = label(names_[i], parts_[i], stream.points);
    json()["attributes"][names_[i]] = accessor;
    attributes[names_[i]] = stream.unique_ids[i];
  }
  std::optional<std::size_t> old = primitive_.source.indices;
  if (!primitive_.source.draco || !old || from_.references[*old] != 1) old.reset();
  PackedValues shape;
  const bool wide = stream.points > 0xFFFF;
  shape.type = wide ? ComponentType::u32 : ComponentType::u16;
  shape.count = stream.triangles * 3;
  const std::size_t indices = output_.label(old, shape, Bounds::left_out);
  Json& primitive = json();
  primitive["indices"] = indices;
  if (primitive_.source.mode != PrimitiveMode::triangles) primitive["mode"] = 4;
  Json& extension = primitive["extensions"][kDracoExtension];
  extension["bufferView"] = view;
  extension["attributes"] = std::move(attributes);
  require_extension(kDracoExtension, output_.json());
}

Result<void> PrimitiveCompressor::run() {
  if (auto done = add_moved(); !done) return done;
  add_new();
  if (auto done = add_compressed(); !done) return done;
  const DracoOrder order = order_is_free() ? DracoOrder::free : DracoOrder::kept;
  DracoSource source;
  source.triangles = std::span(from_.surface.mesh.triangles)
                         .subspan(primitive_.first_triangle, primitive_.triangles);
  source.first_point = block_.first;
  source.points = block_.count;
  // Lent to the encoder; the labels need them afterwards.
  source.parts = std::move(parts_);
  auto stream = encode_draco(source, from_.options.level, order);
  parts_ = std::move(source.parts);
  if (!stream) return stream.error();
  write(*std::move(stream));
  return {};
}

}  // namespace

Result<void> compress_primitive(const DracoPatchSource& source, const SurfacePrimitive& primitive,
                                GltfOutput& output) {
  return PrimitiveCompressor(source, primitive, output).run();
}

}  // namespace fairway
