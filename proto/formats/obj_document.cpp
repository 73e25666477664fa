// An OBJ that comes back with the numbers of its lines v and vn replaced and all else kept.

#include <Eigen/Geometry>
#include <cmath>

#include "proto/formats/obj_extras.h"
#include "proto/formats/obj_surface.h"
#include "proto/formats/polygons.h"
#include "proto/formats/shape_document.h"
#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

class ObjDocument final : public ShapeDocument {
 public:
  ObjDocument(ByteSpan bytes, ObjSurface obj) : ShapeDocument(bytes, Format::obj) {
    surfaces_.push_back(std::move(obj.surface));
    obj.surface = {};
    obj_ = std::move(obj);
    const bool colored = obj_.colors == surfaces_.front().mesh.positions.size();
    facts_.extras = {colored ? 3 : 0, !obj_.texture_of_vertex.empty()};
    facts_.left_behind = left_behind();
  }

  Result<ColorValues> read_colors() const override;
  Result<std::vector<float>> read_texture_coordinates() const override {
    return read_obj_texture_coordinates(as_text(source()), obj_.texture_of_vertex);
  }

 private:
  Result<std::vector<std::byte>> patch(const SurfaceResult& result) const override;
  std::vector<std::string> left_behind() const;
  std::vector<Vec3> sum_normals(const std::vector<Vec3>& positions) const;
  std::vector<Vec3> new_normals(const std::vector<Vec3>& positions) const;

  ObjSurface obj_;  ///< without the surface
};

std::vector<std::string> ObjDocument::left_behind() const {
  std::vector<std::string> out;
  const auto add = [&out](std::size_t count, std::string_view name) {
    if (count > 0) out.push_back(counted(count, name));
  };
  add(obj_.normals.size(), "normal");
  if (!facts_.extras.texture_coordinates) add(obj_.texture_coordinates, "texture coordinate");
  if (facts_.extras.color_components == 0) add(obj_.colors, "colour of a vertex");
  add(obj_.materials, "choice of a material");
  add(obj_.groups, "group");
  add(obj_.polygons, "polygon of more than three corners");
  return out;
}

Result<ColorValues> ObjDocument::read_colors() const {
  if (facts_.extras.color_components == 0) return ColorValues{};
  std::vector<std::string_view> last_words;
  last_words.reserve(obj_.position_words.size() / 3);
  for (std::size_t i = 2; i < obj_.position_words.size(); i += 3) {
    last_words.push_back(obj_.position_words[i]);
  }
  return read_obj_colors(as_text(source()), last_words);
}

/// For each line vn, the normals of the triangles whose corners name it, weighted by area.
std::vector<Vec3> ObjDocument::sum_normals(const std::vector<Vec3>& positions) const {
  std::vector<Vec3> sums(obj_.normals.size(), Vec3::Zero());
  for (std::size_t i = 0; i + 2 < obj_.corners.size(); i += 3) {
    const Vec3& a = positions[obj_.corners[i].vertex];
    const Vec3 normal = (positions[obj_.corners[i + 1].vertex] - a)
                            .cross(positions[obj_.corners[i + 2].vertex] - a);
    for (std::size_t c = i; c < i + 3; ++c) {
      if (obj_.corners[c].normal != kNoIndex) sums[obj_.corners[c].normal] += normal;
    }
  }
  return sums;
}

/// A line that no face with area names keeps its normal, and one that pointed inward still does.
std::vector<Vec3> ObjDocument::new_normals(const std::vector<Vec3>& positions) const {
  const std::vector<Vec3> before = sum_normals(surfaces_.front().mesh.positions);
  std::vector<Vec3> out = sum_normals(positions);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double length = out[k].norm();
    if (!(length > 0.0) || !std::isfinite(length) || out[k] == before[k]) {
      out[k] = obj_.normals[k];
    } else {
      out[k] *= (before[k].dot(obj_.normals[k]) < 0.0 ? -1.0 : 1.0) / length;
    }
  }
  return out;
}

/// Words of three numbers each that are not what they were.
struct Lines {
  const std::vector<std::string_view>& words;
  const std::vector<Vec3>& before;
  const std::vector<Vec3>& now;
  bool floats = true;

  void replace(std::size_t i, TextPatch& patch) const {
    if (before[i] == now[i]) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = now[i][static_cast<Eigen::Index>(c)];
      patch.replace(words[3 * i + c],
                    floats ? shortest(static_cast<float>(value)) : shortest(value));
    }
  }
};

Result<std::vector<std::byte>> ObjDocument::patch(const SurfaceResult& result) const {
  const std::vector<Vec3>& positions = surfaces_.front().mesh.positions;
  const std::vector<Vec3> normals = new_normals(result.positions);
  const Lines vertex_lines{obj_.position_words, positions, result.positions, fit_floats(positions)};
  const Lines normal_lines{obj_.normal_words, obj_.normals, normals, true};
  TextPatch patch(as_text(source()));
  // The two kinds of lines stand in any order.
  std::size_t v = 0;
  std::size_t n = 0;
  while (v < positions.size() || n < normals.size()) {
    const bool vertex_first = n == normals.size() ||
                              (v < positions.size() &&
                               obj_.position_words[3 * v].data() < obj_.normal_words[3 * n].data());
    if (vertex_first) {
      vertex_lines.replace(v++, patch);
    } else {
      normal_lines.replace(n++, patch);
    }
  }
  return patch.finish();
}

}  // namespace

Result<std::unique_ptr<Document>> decode_obj(ByteSpan bytes) {
  auto obj = read_obj_surface(as_text(bytes));
  if (!obj) return obj.error();
  return std::unique_ptr<Document>(std::make_unique<ObjDocument>(bytes, *std::move(obj)));
}

}  // namespace fairway
