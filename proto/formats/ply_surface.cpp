// From the elements of a PLY to a surface.

#include "proto/formats/ply_surface.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proto/formats/ply_values.h"
#include "proto/formats/polygons.h"

namespace fairway {
namespace {

using Columns = std::array<std::size_t, 3>;

constexpr std::array<std::string_view, 3> kPosition = {"x", "y", "z"};
constexpr std::array<std::string_view, 3> kNormal = {"nx", "ny", "nz"};

/// Three scalar properties of a real type.
std::optional<Columns> find_columns(const PlyElement& element,
                                    const std::array<std::string_view, 3>& names) {
  Columns out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto found = element.find(names[c]);
    if (!found) return std::nullopt;
    const PlyProperty& property = element.properties[*found];
    if (property.list_size || !is_real(property.type)) return std::nullopt;
    out[c] = *found;
  }
  return out;
}

class SurfaceReader {
 public:
  SurfaceReader(PlyHeader header, ByteSpan body) : values_(body, header.encoding) {
    out_.header = std::move(header);
  }
  Result<PlySurface> read();

 private:
  Result<void> find_vertices();
  Result<void> read_vertices(const PlyElement& element);
  Result<void> read_vertex(const PlyElement& element);
  Result<void> read_polygons(const PlyElement& element);
  Result<void> read_list(const PlyProperty& property);
  Result<void> add_polygon(bool strips);
  Result<void> pass(const PlyElement& element);

  PlyValues values_;
  PlySurface out_;
  std::size_t vertices_ = 0;
  std::vector<double> row_;  ///< position and normal of one vertex
  std::vector<int> slot_;    ///< of each vertex property in the row, −1 elsewhere
  std::vector<std::int64_t> list_;
  std::vector<Index> corners_;
};

Result<void> SurfaceReader::find_vertices() {
  const PlyElement* vertex = out_.header.find("vertex");
  const PlyElement* face = out_.header.find("face");
  const PlyElement* strips = out_.header.find("tristrips");
  if (vertex == nullptr || vertex->count == 0 ||
      ((face == nullptr || face->count == 0) && (strips == nullptr || strips->count == 0))) {
    return Error{ErrorCode::no_triangles,
                 "The PLY has no vertices or no faces; mesh the points first."};
  }
  const auto position = find_columns(*vertex, kPosition);
  if (!position) {
    return Error{ErrorCode::unsupported_feature,
                 "The PLY's vertices need x, y and z of type float or double; convert them."};
  }
  out_.position = *position;
  out_.normal = find_columns(*vertex, kNormal);
  for (const std::size_t column : out_.position) {
    if (vertex->properties[column].type == PlyType::f64) out_.surface.single_precision = false;
  }
  slot_.assign(vertex->properties.size(), -1);
  for (std::size_t c = 0; c < 3; ++c) {
    slot_[out_.position[c]] = static_cast<int>(c);
    if (out_.normal) slot_[(*out_.normal)[c]] = static_cast<int>(c + 3);
  }
  vertices_ = static_cast<std::size_t>(vertex->count);
  return {};
}

Result<void> SurfaceReader::read_vertex(const PlyElement& element) {
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    if (slot_[p] < 0) {
      if (auto skipped = values_.skip(property); !skipped) return skipped;
      continue;
    }
    const auto taken = values_.take(property.type);
    if (!taken) return taken.error();
    const auto value = values_.value(*taken, property.type);
    // Old normals only tell which vertices share one: a broken one is none.
    if (!value && slot_[p] < 3) {
      return Error{ErrorCode::invalid_mesh,
                   fmt::format("The position of vertex {} is not finite; remove such vertices.",
                               out_.surface.mesh.positions.size())};
    }
    row_[static_cast<std::size_t>(slot_[p])] = value.value_or(0.0);
  }
  return {};
}

Result<void> SurfaceReader::read_vertices(const PlyElement& element) {
  if (vertices_ >= kNoIndex) {
    return Error{ErrorCode::too_large, "The PLY has too many vertices; split it first."};
  }
  Surface& surface = out_.surface;
  out_.vertices_begin = values_.offset();
  row_.assign(6, 0.0);
  surface.mesh.positions.reserve(vertices_);
  if (out_.normal) surface.normals.reserve(vertices_);
  for (std::size_t v = 0; v < vertices_; ++v) {
    if (auto begun = values_.begin_record(); !begun) return begun;
    if (auto read = read_vertex(element); !read) return read;
    if (auto ended = values_.end_record(); !ended) return ended;
    surface.mesh.positions.emplace_back(row_[0], row_[1], row_[2]);
    if (!out_.normal) continue;
    const Vec3 normal(row_[3], row_[4], row_[5]);
    const double length = normal.norm();
    const bool usable = length > 0.0 && std::isfinite(length);
    surface.normals.push_back(usable ? Vec3(normal / length) : Vec3(Vec3::Zero()));
  }
  out_.vertices_end = values_.offset();
  return {};
}

Result<void> SurfaceReader::read_list(const PlyProperty& property) {
  const auto count = values_.take_count(*property.list_size);
  if (!count) return count.error();
  list_.clear();
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto taken = values_.take(property.type);
    if (!taken) return taken.error();
    const auto value = values_.value(*taken, property.type);
    if (!value) {
      return Error{ErrorCode::invalid_mesh,
                   "A face of the PLY has an index that is no number of "
                   "its type; correct its indices."};
    }
    list_.push_back(static_cast<std::int64_t>(*value));
  }
  return {};
}

Result<void> SurfaceReader::add_polygon(bool strips) {
  std::vector<Triangle>& triangles = out_.surface.mesh.triangles;
  if (strips) return add_strips(list_, vertices_, triangles);
  corners_.clear();
  for (const std::int64_t index : list_) {
    const auto corner = check_index(index, vertices_);
    if (!corner) return corner.error();
    corners_.push_back(*corner);
  }
  return add_fan(corners_, triangles);
}

Result<void> SurfaceReader::read_polygons(const PlyElement& element) {
  auto which = element.find("vertex_indices");
  if (!which) which = element.find("vertex_index");
  if (!which || !element.properties[*which].list_size || is_real(element.properties[*which].type)) {
    return Error{ErrorCode::invalid_mesh,
                 "The PLY's faces need a list vertex_indices of integers; export it again."};
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (auto begun = values_.begin_record(); !begun) return begun;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      auto done = p == *which ? read_list(property) : values_.skip(property);
      if (!done) return done;
    }
    if (auto ended = values_.end_record(); !ended) return ended;
    if (auto added = add_polygon(element.name == "tristrips"); !added) return added;
  }
  return {};
}

Result<void> SurfaceReader::pass(const PlyElement& element) {
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (auto begun = values_.begin_record(); !begun) return begun;
    for (const PlyProperty& property : element.properties) {
      if (auto skipped = values_.skip(property); !skipped) return skipped;
    }
    if (auto ended = values_.end_record(); !ended) return ended;
  }
  return {};
}

Result<PlySurface> SurfaceReader::read() {
  if (auto found = find_vertices(); !found) return found.error();
  const std::vector<PlyElement> elements = out_.header.elements;
  for (const PlyElement& element : elements) {
    if (auto possible = values_.check_count(element); !possible) return possible.error();
    if (element.count == 0) continue;
    const bool polygons = element.name == "face" || element.name == "tristrips";
    const Result<void> done = element.name == "vertex" ? read_vertices(element)
                              : polygons               ? read_polygons(element)
                                                       : pass(element);
    if (!done) return done.error();
  }
  if (out_.surface.mesh.triangles.empty()) {
    return Error{ErrorCode::no_triangles, "The PLY has no triangles to denoise."};
  }
  out_.surface.name = "mesh";
  const PlyElement& vertex = *out_.header.find("vertex");
  const bool colored =
      std::any_of(kPlyColors.begin(), kPlyColors.end() - 1,
                  [&](std::string_view key) { return vertex.find(key).has_value(); });
  out_.surface.primitives.push_back(
      {.count = static_cast<Index>(vertices_), .has_colors = colored});
  return std::move(out_);
}

}  // namespace

Result<PlySurface> read_ply_surface(ByteSpan bytes) {
  auto header = read_ply_header(bytes);
  if (!header) return header.error();
  const std::size_t size = header->size;
  return SurfaceReader(*std::move(header), bytes.subspan(size)).read();
}

}  // namespace fairway
