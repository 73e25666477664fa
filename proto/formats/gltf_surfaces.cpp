// From the meshes of a glTF to surfaces: one per mesh, over all its triangle primitives.

#include "proto/formats/gltf_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "proto/formats/finite.h"
#include "proto/formats/gltf_accessor.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_meshopt.h"
#include "proto/formats/gltf_nodes.h"

namespace fairway {
namespace {

/// How often the primitives of one mesh may draw the same triangles.
constexpr std::size_t kMaxRepeats = 64;
/// How often all meshes together may use each element that Draco data decoded to.
constexpr std::uint64_t kSharesOfDecoded = 8;

using Accessor = std::optional<std::size_t>;

/// The first position that is not finite; one is.
std::ptrdiff_t first_not_finite(std::span<const Vec3> positions) {
  return std::find_if_not(positions.begin(), positions.end(),
                          [](const Vec3& p) { return p.allFinite(); }) -
         positions.begin();
}

/// Appends triangles whose vertices are counted from `first`.
void append_triangles(std::vector<Triangle> triangles, Index first, std::vector<Triangle>& out) {
  if (first == 0 && out.empty()) {
    out = std::move(triangles);
    return;
  }
  out.reserve(out.size() + triangles.size());
  for (const auto [a, b, c] : triangles) out.push_back({a + first, b + first, c + first});
}

/// Builds the surfaces mesh by mesh and keeps count of what the file makes us store.
class SurfaceGatherer {
 public:
  SurfaceGatherer(const JsonPlace& root, GltfTables& tables)
      : root_(root), tables_(tables), quantized_(uses_extension(root, "KHR_mesh_quantization")) {}

  Result<void> add_mesh(const JsonPlace& mesh, std::size_t index);
  GltfSurfaces take() { return std::move(out_); }

 private:
  Result<void> add_primitive(const JsonPlace& place, std::size_t index, Surface& surface,
                             SurfacePlan& plan);
  Result<void> decode(const JsonPlace& place, const TriangleSource& source);
  Result<std::size_t> block_of(const JsonPlace& place, const TriangleSource& source,
                               Surface& surface, SurfacePlan& plan);
  Result<void> read_block(const JsonPlace& place, const TriangleSource& source,
                          const VertexBlock& block, Surface& surface);
  Result<bool> append_positions(const TriangleSource& source, std::size_t accessor,
                                std::vector<Vec3>& out) const;
  Result<std::vector<double>> read_attribute(const TriangleSource& source, std::string_view name,
                                             std::size_t accessor) const;
  Result<void> check_position(const JsonPlace& place, const TriangleSource& source);
  Result<void> check_repeats(const JsonPlace& place, const TriangleSource& source);
  Result<void> spend(const JsonPlace& place, std::uint64_t elements);
  void note(std::string_view text);

  JsonPlace root_;
  GltfTables& tables_;
  bool quantized_;
  std::uint64_t spent_ = 0;
  std::uint64_t decoded_ = 0;
  std::uint64_t draco_bytes_ = 0;  ///< of all views that were decoded
  // Of the mesh at hand: POSITION, indices and Draco view of its primitives; POSITION, NORMAL and
  // Draco view of its blocks.
  std::map<std::tuple<std::size_t, Accessor, Accessor>, std::size_t> repeats_;
  std::map<std::tuple<std::size_t, Accessor, Accessor>, std::size_t> block_of_;
  GltfSurfaces out_;
};

void SurfaceGatherer::note(std::string_view text) {
  if (std::find(out_.notes.begin(), out_.notes.end(), text) == out_.notes.end()) {
    out_.notes.emplace_back(text);
  }
}

/// Vertices and triangles of all surfaces together stay in proportion to the bytes that came.
Result<void> SurfaceGatherer::spend(const JsonPlace& place, std::uint64_t elements) {
  spent_ += elements;
  if (spent_ > tables_.element_limit + decoded_ * kSharesOfDecoded) {
    return place.error(
        "the meshes together have more vertices and triangles than a file of this size may; store "
        "shared parts once.");
  }
  return {};
}

Result<void> SurfaceGatherer::check_repeats(const JsonPlace& place, const TriangleSource& source) {
  const std::optional<std::size_t> draco =
      source.draco ? std::optional(source.draco->view) : std::nullopt;
  std::size_t& repeats = repeats_[{source.position(), source.indices, draco}];
  if (++repeats <= kMaxRepeats) return {};
  return place.error(
      fmt::format("a mesh may draw the same triangles {} times, not more.", kMaxRepeats));
}

/// Integer positions that no extension announces are believed where the bounds bear them out.
Result<void> SurfaceGatherer::check_position(const JsonPlace& place, const TriangleSource& source) {
  const GltfAccessor& accessor = tables_.accessors[source.position()];
  if (!accessor.is_vector(3)) return place.error("POSITION must be a VEC3.");
  if (accessor.type == ComponentType::f32) return {};
  if (accessor.type == ComponentType::u32) return place.error("POSITION must be of floats.");
  if (quantized_) return {};
  constexpr const char* kUndeclared =
      "POSITION must be of floats, or KHR_mesh_quantization be declared.";
  const auto stored = read_stored(tables_, source.position());
  if (!stored || source.draco) return place.error(kUndeclared);
  const JsonPlace def = (*root_.find("accessors"))[source.position()];
  for (std::size_t c = 0; c < 3; ++c) {
    double low = (*stored)[c];
    double high = low;
    for (std::size_t i = c; i < stored->size(); i += 3) {
      low = std::min(low, (*stored)[i]);
      high = std::max(high, (*stored)[i]);
    }
    for (const auto& [key, bound] : {std::pair{"min", low}, std::pair{"max", high}}) {
      const auto list = def.find(key);
      if (!list || !list->json().is_array() || list->size() != 3 || !list->json()[c].is_number() ||
          list->json()[c].get<double>() != bound) {
        return place.error(kUndeclared);
      }
    }
  }
  note("integer positions are read although KHR_mesh_quantization is not declared");
  return {};
}

Result<std::vector<double>> SurfaceGatherer::read_attribute(const TriangleSource& source,
                                                            std::string_view name,
                                                            std::size_t accessor) const {
  if (source.draco) {
    const DracoMesh& mesh = out_.layout.draco_meshes.at(source.draco->view);
    const auto id = source.draco->ids.find(name);
    if (id != source.draco->ids.end()) {
      return draco_values(mesh, *mesh.find_unique(id->second), tables_.accessors[accessor]);
    }
  }
  return read_values(tables_, accessor);
}

/// Returns whether they are finite.
Result<bool> SurfaceGatherer::append_positions(const TriangleSource& source, std::size_t accessor,
                                               std::vector<Vec3>& out) const {
  if (!source.draco) return append_vectors(tables_, accessor, out);
  const auto numbers = read_attribute(source, "POSITION", accessor);
  if (!numbers) return numbers.error();
  out.reserve(out.size() + numbers->size() / 3);
  for (std::size_t i = 0; i < numbers->size(); i += 3) {
    out.emplace_back((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
  }
  return all_finite(*numbers);
}

Result<void> SurfaceGatherer::read_block(const JsonPlace& place, const TriangleSource& source,
                                         const VertexBlock& block, Surface& surface) {
  const auto finite = append_positions(source, block.position, surface.mesh.positions);
  if (!finite) return finite.error();
  if (!*finite) {
    const auto at = first_not_finite(std::span(surface.mesh.positions).subspan(block.first));
    return place.error(
        fmt::format("the position of vertex {} is not finite; remove such vertices first.", at));
  }
  if (block.normal) {
    const auto normals = read_attribute(source, "NORMAL", *block.normal);
    if (!normals) return normals.error();
    surface.normals.resize(surface.mesh.positions.size(), Vec3::Zero());
    for (std::size_t i = 0; i < block.count; ++i) {
      const Vec3 normal((*normals)[3 * i], (*normals)[3 * i + 1], (*normals)[3 * i + 2]);
      const double length = normal.norm();
      if (length > 0.0 && std::isfinite(length)) surface.normals[block.first + i] = normal / length;
    }
  }
  if (!surface.normals.empty()) surface.normals.resize(surface.mesh.positions.size(), Vec3::Zero());
  return {};
}

Result<void> SurfaceGatherer::decode(const JsonPlace& place, const TriangleSource& source) {
  const DracoUse& use = *source.draco;
  if (!out_.layout.draco_meshes.contains(use.view)) {
    // Views may share bytes; each view is decoded for itself.
    draco_bytes_ += tables_.views[use.view].length;
    if (draco_bytes_ > tables_.element_limit) {
      return place.error("the views with Draco data share their bytes too often; store it once.");
    }
  }
  const std::size_t before = out_.layout.draco_meshes.size();
  if (auto done =
          decode_draco_use(place, use, source.attributes, tables_, out_.layout.draco_meshes);
      !done)
    return done;
  if (out_.layout.draco_meshes.size() > before) {
    const DracoMesh& mesh = out_.layout.draco_meshes.at(use.view);
    decoded_ += mesh.triangles().size() + mesh.point_count();
  }
  return {};
}

Result<std::size_t> SurfaceGatherer::block_of(const JsonPlace& place, const TriangleSource& source,
                                              Surface& surface, SurfacePlan& plan) {
  VertexBlock block;
  block.position = source.position();
  block.normal = source.attribute("NORMAL");
  if (source.draco) block.draco_view = source.draco->view;
  const auto [found, is_new] =
      block_of_.try_emplace({block.position, block.normal, block.draco_view}, plan.blocks.size());
  if (!is_new) return found->second;
  if (auto done = check_position(place, source); !done) return done.error();
  if (block.normal && !tables_.accessors[*block.normal].is_vector(3)) {
    return place.error("NORMAL must be a VEC3.");
  }
  const auto count = vertex_count(place, source, tables_, out_.layout.draco_meshes);
  if (!count) return count.error();
  if (auto done = spend(place, *count); !done) return done.error();
  if (surface.mesh.positions.size() + *count >= kNoIndex) {
    return place.error("the mesh has more vertices than an index can name.");
  }
  block.first = static_cast<Index>(surface.mesh.positions.size());
  block.count = *count;
  if (auto done = read_block(place, source, block, surface); !done) return done.error();
  plan.blocks.push_back(block);
  return plan.blocks.size() - 1;
}

Result<void> SurfaceGatherer::add_primitive(const JsonPlace& place, std::size_t index,
                                            Surface& surface, SurfacePlan& plan) {
  auto source = read_primitive(place, tables_);
  if (!source) return source.error();
  if (!*source) {
    note("points and lines stay as they are");
    return {};
  }
  if (auto done = check_repeats(place, **source); !done) return done;
  if (auto done = decode_views(**source, tables_); !done) return done;
  if ((*source)->draco) {
    if (auto done = decode(place, **source); !done) return done;
  }
  const auto block = block_of(place, **source, surface, plan);
  if (!block) return block.error();
  if (auto done = spend(place, triangle_estimate(**source, tables_, out_.layout.draco_meshes));
      !done) {
    return done;
  }
  const VertexBlock& vertices = plan.blocks[*block];
  auto triangles =
      read_triangles(place, **source, vertices.count, tables_, out_.layout.draco_meshes);
  if (!triangles) return triangles.error();
  const std::size_t first_triangle = surface.mesh.triangles.size();
  append_triangles(*std::move(triangles), vertices.first, surface.mesh.triangles);
  if (place.has("targets")) note("morph targets keep their deltas");
  surface.primitives.push_back({index, vertices.position, vertices.draco_view, vertices.first,
                                vertices.count, (*source)->attribute("COLOR_0").has_value()});
  plan.primitives.push_back({index, **std::move(source), *block, first_triangle,
                             surface.mesh.triangles.size() - first_triangle});
  return {};
}

Result<void> SurfaceGatherer::add_mesh(const JsonPlace& mesh, std::size_t index) {
  if (!mesh.json().is_object()) return mesh.error("this must be an object.");
  const auto primitives = mesh.array("primitives");
  if (!primitives) return primitives.error();
  if (!*primitives || (*primitives)->size() == 0) return mesh.error("it has no primitives.");
  Surface surface;
  surface.name = fmt::format("meshes/{}", index);
  surface.mesh_index = index;
  SurfacePlan plan;
  plan.mesh = index;
  repeats_.clear();
  block_of_.clear();
  for (std::size_t i = 0; i < (*primitives)->size(); ++i) {
    if (auto done = add_primitive((**primitives)[i], i, surface, plan); !done) return done;
  }
  if (surface.mesh.triangles.empty()) return {};
  out_.surfaces.push_back(std::move(surface));
  out_.layout.plans.push_back(std::move(plan));
  return {};
}

bool has_skinned_node(const JsonPlace& root) {
  const auto nodes = root.find("nodes");
  if (!nodes) return false;
  return std::any_of(nodes->json().begin(), nodes->json().end(), [](const Json& node) {
    return node.contains("mesh") && node.contains("skin");
  });
}

}  // namespace

Result<GltfSurfaces> gather_surfaces(const JsonPlace& root, GltfTables& tables) {
  const auto meshes = root.array("meshes");
  if (!meshes) return meshes.error();
  SurfaceGatherer gatherer(root, tables);
  for (std::size_t i = 0; *meshes && i < (*meshes)->size(); ++i) {
    if (auto done = gatherer.add_mesh((**meshes)[i], i); !done) return done.error();
  }
  GltfSurfaces out = gatherer.take();
  if (out.surfaces.empty()) {
    return Error{ErrorCode::no_triangles,
                 "The file has no triangles to denoise; send a mesh with triangle primitives."};
  }
  const std::vector<WorldScale> scales = world_scales(root, (*meshes)->size());
  for (Surface& surface : out.surfaces) surface.world_scale = scales[surface.mesh_index];
  if (has_skinned_node(root)) out.notes.emplace_back("skinned: the bind pose is denoised");
  return out;
}

}  // namespace fairway
