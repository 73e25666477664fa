// From the lines of an OBJ to a surface. Source: Wavefront, "Object Files (.obj)", Advanced
// Visualizer, appendix B1.

#include "proto/formats/obj_surface.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "proto/formats/obj_extras.h"
#include "proto/formats/polygons.h"
#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

constexpr std::size_t kVertex = 0;
constexpr std::size_t kTexture = 1;
constexpr std::size_t kNormal = 2;

class SurfaceReader {
 public:
  explicit SurfaceReader(std::string_view text) : lines_(text, Continuation::backslash) {}
  Result<ObjSurface> read();

 private:
  Result<void> take(std::string_view line);
  Result<void> take_vertex(std::string_view rest);
  Result<void> take_normal(std::string_view rest);
  Result<void> take_face(std::string_view rest);
  Result<std::array<Index, 3>> read_corner(std::string_view word);
  Result<Index> resolve(std::string_view word, std::size_t kind);
  Result<void> check_references() const;
  Error error(std::string_view what, ErrorCode code = ErrorCode::invalid_mesh) const {
    return {code, fmt::format("OBJ, line {}: {}", lines_.number(), what)};
  }

  LineReader lines_;
  ObjSurface out_;
  std::array<std::uint64_t, 3> count_ = {};    ///< of v, vt, vn so far
  std::array<std::uint64_t, 3> highest_ = {};  ///< that faces name, from 1
  TextureOfVertex texture_of_vertex_;
  std::vector<Index> polygon_;  ///< corners of a face, in corner_list_
  std::vector<ObjCorner> corner_list_;
};

/// Three numbers and their words, from the front of `rest`.
std::optional<Vec3> take_numbers(std::string_view& rest, std::vector<std::string_view>& words) {
  Vec3 out = Vec3::Zero();
  bool good = true;
  for (int c = 0; c < 3; ++c) {
    words.push_back(next_word(rest));
    const auto value = parse_real(words.back());
    good = good && value.has_value();
    out[c] = value.value_or(0.0);
  }
  if (!good) return std::nullopt;
  return out;
}

/// Just so many words, up to a comment.
bool has_words(std::string_view rest, int count) {
  int words = 0;
  for (auto word = next_word(rest); !word.empty() && word[0] != '#'; word = next_word(rest)) {
    if (++words > count) return false;
  }
  return words == count;
}

Result<void> SurfaceReader::take_vertex(std::string_view rest) {
  const auto position = take_numbers(rest, out_.position_words);
  if (!position) return error("a vertex is not three finite numbers; repair the file.");
  if (++count_[kVertex] >= kNoIndex) {
    return error("there are too many vertices; split the mesh.", ErrorCode::too_large);
  }
  out_.surface.mesh.positions.push_back(*position);
  if (!rest.empty() && has_words(rest, 3)) ++out_.colors;
  return {};
}

Result<void> SurfaceReader::take_normal(std::string_view rest) {
  const auto normal = take_numbers(rest, out_.normal_words);
  if (out_.normal_words.back().empty())
    return error("a normal has three numbers; repair the file.");
  if (++count_[kNormal] >= kNoIndex) {
    return error("there are too many normals; split the mesh.", ErrorCode::too_large);
  }
  out_.normals.push_back(normal.value_or(Vec3::Zero()));
  return {};
}

/// From 1, or backwards from −1, to from 0. That lines further down may be meant makes the end
/// known only later.
Result<Index> SurfaceReader::resolve(std::string_view word, std::size_t kind) {
  const auto number = parse_integer(word);
  if (!number) return error("a face has an index that is no integer; repair the file.");
  const auto known = static_cast<std::int64_t>(count_[kind]);
  if (*number == 0 || *number < -known || *number >= std::int64_t{kNoIndex}) {
    return error("a face has an index out of range (they count from 1); repair the file.");
  }
  const std::int64_t index = *number > 0 ? *number : known + *number + 1;
  highest_[kind] = std::max(highest_[kind], static_cast<std::uint64_t>(index));
  return static_cast<Index>(index - 1);
}

/// v, v/vt, v//vn or v/vt/vn.
Result<std::array<Index, 3>> SurfaceReader::read_corner(std::string_view word) {
  std::array<Index, 3> out = {kNoIndex, kNoIndex, kNoIndex};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    const std::size_t slash = word.find('/');
    const std::string_view part = word.substr(0, slash);
    if (!part.empty() || kind == kVertex) {
      const auto index = resolve(part, kind);
      if (!index) return index.error();
      out[kind] = *index;
    }
    if (slash == std::string_view::npos) return out;
    word.remove_prefix(slash + 1);
  }
  return error("a corner has more than three indices; repair the file.");
}

Result<void> SurfaceReader::take_face(std::string_view rest) {
  corner_list_.clear();
  polygon_.clear();
  for (auto word = next_word(rest); !word.empty() && word[0] != '#'; word = next_word(rest)) {
    const auto corner = read_corner(word);
    if (!corner) return corner.error();
    polygon_.push_back(static_cast<Index>(corner_list_.size()));
    corner_list_.push_back({(*corner)[kVertex], (*corner)[kNormal]});
    texture_of_vertex_.add((*corner)[kVertex], out_.surface.mesh.positions.size(),
                           (*corner)[kTexture]);
  }
  if (polygon_.size() < 3) {
    return error("a face has fewer than three corners; remove such faces.");
  }
  if (polygon_.size() > 3) ++out_.polygons;
  std::vector<Triangle> fan;
  if (auto added = add_fan(polygon_, fan); !added) return added;
  std::vector<Triangle>& triangles = out_.surface.mesh.triangles;
  if (fan.size() > kMostTriangles - triangles.size()) {
    return error("there are too many triangles; split the mesh.", ErrorCode::too_large);
  }
  for (const Triangle& triangle : fan) {
    Triangle& of_vertices = triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      out_.corners.push_back(corner_list_[triangle[i]]);
      of_vertices[i] = out_.corners.back().vertex;
    }
  }
  return {};
}

Result<void> SurfaceReader::take(std::string_view line) {
  const std::string_view key = next_word(line);
  if (key == "v") return take_vertex(line);
  if (key == "vn") return take_normal(line);
  if (key == "f") return take_face(line);
  // Everything else stays as it is; a library that is named is not opened.
  if (key == "vt") ++count_[kTexture];
  if (key == "usemtl") ++out_.materials;
  if (key == "g" || key == "o") ++out_.groups;
  return {};
}

Result<void> SurfaceReader::check_references() const {
  constexpr std::array<std::string_view, 3> kLists = {"v", "vt", "vn"};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    if (highest_[kind] <= count_[kind]) continue;
    return Error{ErrorCode::invalid_mesh,
                 fmt::format("A face of the OBJ names line {} of \"{}\", there are {}; repair the "
                             "file.",
                             highest_[kind], kLists[kind], count_[kind])};
  }
  return {};
}

Result<ObjSurface> SurfaceReader::read() {
  while (lines_.next()) {
    if (auto taken = take(lines_.line()); !taken) return taken.error();
  }
  if (lines_.error()) return *lines_.error();
  if (auto checked = check_references(); !checked) return checked.error();
  Surface& surface = out_.surface;
  if (surface.mesh.triangles.empty()) {
    return Error{ErrorCode::no_triangles,
                 "The OBJ has no faces to denoise; export it as polygons."};
  }
  surface.name = "mesh";
  surface.primitives.push_back({.count = static_cast<Index>(surface.mesh.positions.size())});
  surface.single_precision = false;
  out_.texture_coordinates = count_[kTexture];
  out_.texture_of_vertex = texture_of_vertex_.take(surface.mesh.positions.size());
  return std::move(out_);
}

}  // namespace

Result<ObjSurface> read_obj_surface(std::string_view text) {
  return SurfaceReader(text).read();
}

}  // namespace fairway
