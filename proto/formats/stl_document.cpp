// STL: triangle soup, binary or as text. Source: 3D Systems, "StereoLithography Interface
// Specification" (1989), as it is used today.

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "core/weld.h"
#include "proto/formats/polygons.h"
#include "proto/formats/shape_document.h"
#include "proto/formats/stl_triangles.h"
#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

/// Corners in the order of the file.
using Soup = std::vector<Vec3>;

constexpr std::size_t kAttributeOffset = 48;

Error broken(ErrorCode code, std::string message) {
  return {code, std::move(message)};
}

/// Some programs write the keywords in capitals.
std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

Vec3 rounded(const Vec3& v) {
  return v.cast<float>().cast<double>();
}

/// A text STL has "facet" or "endsolid" as the word behind its first line; binary headers may begin
/// with "solid", too.
bool is_text(ByteSpan bytes) {
  LineReader lines(as_text(bytes));
  if (!lines.next()) return false;
  std::string_view first = lines.line();
  if (lower(next_word(first)) != "solid") return false;
  while (lines.next()) {
    std::string_view line = lines.line();
    const std::string word = lower(next_word(line));
    if (!word.empty()) return word == "facet" || word == "endsolid";
  }
  return false;
}

/// Reads the words of an ASCII STL in their order.
class TextReader {
 public:
  explicit TextReader(std::string_view text) : lines_(text) {}

  Result<Soup> read();
  /// The words of the numbers: twelve per triangle, the normal first.
  std::vector<std::string_view>& words() { return words_; }

 private:
  Result<void> take(std::string_view line);
  Result<void> take_facet(std::string_view& rest);
  Result<void> take_vertex(std::string_view& rest);
  Error error(ErrorCode code, std::string_view what) const {
    return broken(code, fmt::format("Line {}: {}", lines_.number(), what));
  }

  enum class Place { outside, solid, facet, loop };
  LineReader lines_;
  Place place_ = Place::outside;
  std::size_t corners_ = 0;  ///< of the loop
  Soup soup_;
  std::vector<std::string_view> words_;
};

Result<void> TextReader::take_facet(std::string_view& rest) {
  if (lower(next_word(rest)) != "normal") {
    return error(ErrorCode::malformed_input, "a facet begins with \"facet normal\".");
  }
  // Normals are made anew: that they are numbers is not asked.
  for (int c = 0; c < 3; ++c) words_.push_back(next_word(rest));
  if (words_.back().empty()) return error(ErrorCode::malformed_input, "a normal has 3 numbers.");
  corners_ = 0;
  place_ = Place::facet;
  return {};
}

Result<void> TextReader::take_vertex(std::string_view& rest) {
  if (++corners_ > 3) {
    return error(ErrorCode::invalid_mesh, "a facet of STL has three corners; triangulate it.");
  }
  Vec3 position;
  for (int c = 0; c < 3; ++c) {
    words_.push_back(next_word(rest));
    const auto value = parse_real(words_.back());
    if (!value || !std::isfinite(static_cast<float>(*value))) {
      return error(ErrorCode::invalid_mesh,
                   "a vertex is not three finite numbers; repair the file.");
    }
    position[c] = *value;
  }
  soup_.push_back(rounded(position));
  return {};
}

Result<void> TextReader::take(std::string_view rest) {
  const std::string key = lower(next_word(rest));
  if (key.empty()) return {};
  if (key == "solid" && place_ == Place::outside) {
    place_ = Place::solid;
  } else if (key == "facet" && place_ == Place::solid) {
    return take_facet(rest);
  } else if (key == "outer" && place_ == Place::facet && corners_ == 0) {
    place_ = Place::loop;
  } else if (key == "vertex" && place_ == Place::loop) {
    return take_vertex(rest);
  } else if (key == "endloop" && place_ == Place::loop) {
    if (corners_ != 3) {
      return error(ErrorCode::invalid_mesh, "a facet of STL has three corners; repair the file.");
    }
    place_ = Place::facet;
  } else if (key == "endfacet" && place_ == Place::facet && corners_ == 3) {
    place_ = Place::solid;
  } else if (key == "endsolid" && place_ == Place::solid) {
    place_ = Place::outside;
  } else {
    return error(ErrorCode::malformed_input,
                 "this is not what an ASCII STL has here; export the mesh again.");
  }
  return {};
}

Result<Soup> TextReader::read() {
  while (lines_.next()) {
    if (auto taken = take(lines_.line()); !taken) return taken.error();
  }
  if (lines_.error()) return *lines_.error();
  if (place_ != Place::outside) {
    return broken(ErrorCode::malformed_input,
                  "The STL ends before \"endsolid\"; send the whole file.");
  }
  return std::move(soup_);
}

Result<Soup> read_binary(ByteSpan bytes) {
  ByteReader reader(bytes);
  const bool has_header = reader.take(kStlHeaderBytes).has_value();
  const auto count = has_header ? reader.read<std::uint32_t>() : std::nullopt;
  if (!count) {
    return broken(ErrorCode::malformed_input, "The STL ends in its header; send the whole file.");
  }
  const std::uint64_t needed = std::uint64_t{*count} * kStlTriangleBytes;
  if (needed > reader.remaining()) {
    // A count beyond all bytes is a lie, not a cut.
    return broken(
        *count > reader.remaining() ? ErrorCode::invalid_mesh : ErrorCode::malformed_input,
        fmt::format("The STL claims {} triangles, which take {} bytes, and {} follow; send the "
                    "whole file.",
                    *count, needed, reader.remaining()));
  }
  if (*count > kMostTriangles) {
    return broken(ErrorCode::too_large, "The STL has too many triangles; split it first.");
  }
  Soup soup;
  soup.reserve(std::size_t{*count} * 3);
  for (std::size_t t = 0; t < *count; ++t) {
    const std::byte* at = bytes.data() + kStlHeaderBytes + 4 + t * kStlTriangleBytes + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12) {
      const auto values = load<std::array<float, 3>>(at);
      soup.emplace_back(values[0], values[1], values[2]);
      if (soup.back().allFinite()) continue;
      return broken(ErrorCode::invalid_mesh,
                    fmt::format("A corner of triangle {} is not finite; remove it.", t));
    }
  }
  return soup;
}

Surface weld(const Soup& soup) {
  const Weld welded = weld_equal_positions(soup);
  Surface surface;
  surface.name = "mesh";
  surface.mesh.positions.reserve(welded.count);
  surface.mesh.triangles.resize(soup.size() / 3);
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const Index vertex = welded.place[i];
    if (vertex == surface.mesh.positions.size()) surface.mesh.positions.push_back(soup[i]);
    surface.mesh.triangles[i / 3][i % 3] = vertex;
  }
  surface.primitives.push_back({.count = static_cast<Index>(welded.count)});
  return surface;
}

class StlDocument final : public ShapeDocument {
 public:
  /// `words`: those of the numbers of an ASCII STL.
  StlDocument(ByteSpan bytes, Surface surface, std::vector<std::string_view> words)
      : ShapeDocument(bytes, Format::stl), words_(std::move(words)) {
    surfaces_.push_back(std::move(surface));
  }

 private:
  Result<std::vector<std::byte>> patch(const SurfaceResult& result) const override {
    return words_.empty() ? patch_binary(result) : patch_text(result);
  }
  std::vector<std::byte> patch_binary(const SurfaceResult& result) const;
  std::vector<std::byte> patch_text(const SurfaceResult& result) const;

  std::vector<std::string_view> words_;
};

std::vector<std::byte> StlDocument::patch_binary(const SurfaceResult& result) const {
  const std::vector<Triangle>& triangles = surfaces_.front().mesh.triangles;
  const ByteSpan head = source().first(kStlHeaderBytes + 4);
  std::vector<std::byte> out;
  out.reserve(source().size());
  append(out, head);
  for (const auto& [a, b, c] : triangles) {
    const auto attribute = load<std::uint16_t>(source().data() + out.size() + kAttributeOffset);
    append_stl_triangle(result.positions[a], result.positions[b], result.positions[c], attribute,
                        out);
  }
  append(out, source().subspan(out.size()));
  return out;
}

std::vector<std::byte> StlDocument::patch_text(const SurfaceResult& result) const {
  TextPatch patch(as_text(source()));
  std::size_t word = 0;
  const auto put = [&](const Vec3& vector) {
    for (int c = 0; c < 3; ++c) {
      patch.replace(words_[word++], shortest(static_cast<float>(vector[c])));
    }
  };
  for (const auto& [a, b, c] : surfaces_.front().mesh.triangles) {
    const std::array<Vec3, 3> corners = {rounded(result.positions[a]), rounded(result.positions[b]),
                                         rounded(result.positions[c])};
    put(unit_normal(corners[0], corners[1], corners[2]));
    for (const Vec3& corner : corners) put(corner);
  }
  return patch.finish();
}

}  // namespace

void append_stl_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::uint16_t attribute,
                         std::vector<std::byte>& out) {
  const std::array<Vec3, 3> corners = {rounded(a), rounded(b), rounded(c)};
  const Vec3 normal = unit_normal(corners[0], corners[1], corners[2]);
  for (const Vec3& v : {normal, corners[0], corners[1], corners[2]}) {
    for (int i = 0; i < 3; ++i) append_value(out, static_cast<float>(v[i]));
  }
  append_value(out, attribute);
}

Result<std::unique_ptr<Document>> decode_stl(ByteSpan bytes) {
  TextReader text(as_text(bytes));
  auto soup = is_text(bytes) ? text.read() : read_binary(bytes);
  if (!soup) return soup.error();
  if (soup->empty()) {
    return Error{ErrorCode::no_triangles, "The STL has no triangles to denoise."};
  }
  return std::unique_ptr<Document>(
      std::make_unique<StlDocument>(bytes, weld(*soup), std::move(text.words())));
}

}  // namespace fairway
