// A PLY that comes back with its positions, normals and attributes replaced and all else kept.

#include <fmt/format.h>

#include "proto/formats/fresh_shape.h"
#include "proto/formats/ply_extras.h"
#include "proto/formats/ply_surface.h"
#include "proto/formats/ply_values.h"
#include "proto/formats/polygons.h"
#include "proto/formats/shape_document.h"

namespace fairway {
namespace {

/// One new value per vertex, for a property that is there or one that is added.
struct Column {
  std::string name;
  const std::vector<Vec3>* vectors = nullptr;  ///< or
  const std::vector<float>* floats = nullptr;
  std::size_t components = 1;
  std::size_t component = 0;
  const std::vector<Srgb>* colors = nullptr;  ///< or

  PlyType type() const { return colors != nullptr ? PlyType::u8 : PlyType::f32; }
  double at(std::size_t vertex) const {
    if (colors != nullptr) return (*colors)[vertex][component];
    if (vectors != nullptr) return (*vectors)[vertex][static_cast<Eigen::Index>(component)];
    return static_cast<double>((*floats)[vertex * components + component]);
  }
};

/// What becomes of the vertices.
struct VertexPlan {
  std::vector<std::optional<Column>> replaced;  ///< one per property
  std::vector<Column> added;
};

class PlyDocument final : public ShapeDocument {
 public:
  PlyDocument(ByteSpan bytes, PlySurface ply) : ShapeDocument(bytes, Format::ply) {
    surfaces_.push_back(std::move(ply.surface));
    ply.surface = {};
    ply_ = std::move(ply);
    extras_ = find_ply_extras(vertex());
    facts_.extras = extras_.kinds();
    facts_.left_behind = left_behind();
  }

  Result<ColorValues> read_colors() const override {
    return read_ply_colors({vertex(), vertices(), ply_.header.encoding}, extras_);
  }
  Result<std::vector<float>> read_texture_coordinates() const override {
    return read_ply_texture_coordinates({vertex(), vertices(), ply_.header.encoding}, extras_);
  }

 private:
  Result<std::vector<std::byte>> patch(const SurfaceResult& result) const override;
  bool holds_attributes() const override { return true; }

  std::vector<std::string> left_behind() const;
  Result<VertexPlan> plan(const SurfaceResult& result) const;
  Result<void> plan_colors(const VertexColors& colors, VertexPlan& plan) const;
  std::vector<std::byte> new_header(const VertexPlan& plan) const;
  Result<std::vector<std::byte>> patch_text(const VertexPlan& plan) const;
  Result<std::vector<std::byte>> patch_binary(const VertexPlan& plan) const;
  ByteSpan body() const { return source().subspan(ply_.header.size); }
  ByteSpan vertices() const {
    return body().subspan(ply_.vertices_begin, ply_.vertices_end - ply_.vertices_begin);
  }
  const PlyElement& vertex() const { return *ply_.header.find("vertex"); }

  PlySurface ply_;  ///< without the surface
  PlyExtras extras_;
};

std::vector<std::string> PlyDocument::left_behind() const {
  std::vector<std::string> out;
  std::size_t elements = 0;
  std::size_t of_faces = 0;
  for (const PlyElement& element : ply_.header.elements) {
    const bool faces = element.name == "face" || element.name == "tristrips";
    if (faces && element.properties.size() > 1) of_faces += element.properties.size() - 1;
    if (!faces && element.name != "vertex") ++elements;
  }
  const std::size_t used = (ply_.normal ? 6 : 3) + extras_.properties();
  const std::size_t of_vertices = vertex().properties.size() - used;
  if (of_vertices > 0) out.push_back(counted(of_vertices, "other property") + " of vertices");
  if (of_faces > 0) out.push_back(counted(of_faces, "other property") + " of faces");
  if (elements > 0) out.push_back(counted(elements, "other element"));
  return out;
}

Result<VertexPlan> PlyDocument::plan(const SurfaceResult& result) const {
  VertexPlan out;
  out.replaced.resize(vertex().properties.size());
  for (std::size_t c = 0; result.moved && c < 3; ++c) {
    out.replaced[ply_.position[c]] = Column{"", &result.positions, nullptr, 3, c};
    if (ply_.normal) out.replaced[(*ply_.normal)[c]] = Column{"", &result.normals, nullptr, 3, c};
  }
  for (const VertexAttribute& attribute : result.attributes) {
    const std::vector<std::string> names = property_names(attribute);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const Column column{names[c], nullptr, &attribute.values, names.size(), c};
      const auto there = vertex().find(names[c]);
      if (!there) {
        out.added.push_back(column);
        continue;
      }
      const PlyProperty& property = vertex().properties[*there];
      if (property.list_size || !is_real(property.type)) {
        return Error{
            ErrorCode::unsupported_feature,
            fmt::format("The PLY has a property {} that is not float or double; rename it.",
                        names[c])};
      }
      out.replaced[*there] = column;
    }
  }
  if (result.colors_vertices(surfaces_.front().primitives.front().has_colors)) {
    if (auto done = plan_colors(*result.colors, out); !done) return done.error();
  }
  return out;
}

Result<void> PlyDocument::plan_colors(const VertexColors& colors, VertexPlan& plan) const {
  for (std::size_t c = 0; c < 3; ++c) {
    const Column column{std::string(kPlyColors[c]), nullptr, nullptr, 3, c, &colors.values};
    const auto there = vertex().find(column.name);
    if (!there) {
      plan.added.push_back(column);
      continue;
    }
    const PlyProperty& property = vertex().properties[*there];
    if (property.list_size || property.type != PlyType::u8) {
      return Error{
          ErrorCode::unsupported_feature,
          fmt::format("The PLY has a property {} that is not uchar; rename it.", column.name)};
    }
    plan.replaced[*there] = column;
  }
  return {};
}

std::vector<std::byte> PlyDocument::new_header(const VertexPlan& plan) const {
  std::vector<std::byte> out;
  append(out, source().first(ply_.header.vertex_end));
  for (const Column& column : plan.added) {
    append(out,
           as_bytes(fmt::format("property {} {}{}", column.colors != nullptr ? "uchar" : "float",
                                column.name, ply_.header.line_end)));
  }
  append(out, source().subspan(ply_.header.vertex_end, ply_.header.size - ply_.header.vertex_end));
  return out;
}

Result<std::vector<std::byte>> PlyDocument::patch_binary(const VertexPlan& plan) const {
  const PlyEncoding encoding = ply_.header.encoding;
  const std::size_t count = surfaces_.front().mesh.positions.size();
  PlyValues values(vertices(), encoding);
  std::vector<std::byte> out;
  out.reserve(vertices().size() + count * plan.added.size() * sizeof(float));
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t p = 0; p < plan.replaced.size(); ++p) {
      const PlyProperty& property = vertex().properties[p];
      const std::size_t begin = values.offset();
      if (auto skipped = values.skip(property); !skipped) return skipped.error();
      if (plan.replaced[p]) {
        append_ply_value(plan.replaced[p]->at(v), property.type, encoding, out);
      } else {
        append(out, vertices().subspan(begin, values.offset() - begin));
      }
    }
    for (const Column& column : plan.added) {
      append_ply_value(column.at(v), column.type(), encoding, out);
    }
  }
  return out;
}

Result<std::vector<std::byte>> PlyDocument::patch_text(const VertexPlan& plan) const {
  PlyValues values(vertices(), PlyEncoding::ascii);
  TextPatch patch(as_text(vertices()));
  for (std::size_t v = 0; v < surfaces_.front().mesh.positions.size(); ++v) {
    if (auto begun = values.begin_record(); !begun) return begun.error();
    for (std::size_t p = 0; p < plan.replaced.size(); ++p) {
      const PlyProperty& property = vertex().properties[p];
      if (!plan.replaced[p]) {
        if (auto skipped = values.skip(property); !skipped) return skipped.error();
        continue;
      }
      const auto taken = values.take(property.type);
      if (!taken) return taken.error();
      const double now = plan.replaced[p]->at(v);
      // What did not move keeps its digits.
      if (values.value(*taken, property.type) != as_type(now, property.type)) {
        patch.replace(as_text(*taken), ply_word(now, property.type));
      }
    }
    std::string added;
    for (const Column& column : plan.added) {
      added += ' ';
      added += ply_word(column.at(v), column.type());
    }
    patch.insert_behind(values.last_word(), added);
  }
  return patch.finish();
}

Result<std::vector<std::byte>> PlyDocument::patch(const SurfaceResult& result) const {
  const auto columns = plan(result);
  if (!columns) return columns.error();
  const auto patched =
      ply_.header.encoding == PlyEncoding::ascii ? patch_text(*columns) : patch_binary(*columns);
  if (!patched) return patched.error();
  std::vector<std::byte> out = new_header(*columns);
  append(out, body().first(ply_.vertices_begin));
  append(out, *patched);
  append(out, body().subspan(ply_.vertices_end));
  return out;
}

}  // namespace

Result<std::unique_ptr<Document>> decode_ply(ByteSpan bytes) {
  auto ply = read_ply_surface(bytes);
  if (!ply) return ply.error();
  return std::unique_ptr<Document>(std::make_unique<PlyDocument>(bytes, *std::move(ply)));
}

}  // namespace fairway
