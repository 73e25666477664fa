// Colours behind the positions of an OBJ (no part of its specification, but widely written: sRGB
// from 0 to 1), and texture coordinates of vertices.

#include "proto/formats/obj_extras.h"

#include <optional>

#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

Error no_numbers(std::string_view what) {
  return {ErrorCode::invalid_mesh, std::string(what) + " of the OBJ are no numbers."};
}

}  // namespace

void TextureOfVertex::add(Index vertex, std::size_t known, Index line) {
  // A vertex whose line is still to come proves no size.
  if (line == kNoIndex || vertex >= known) one_each_ = false;
  if (!one_each_) return;
  if (vertex >= line_of_.size()) line_of_.resize(known, kNoIndex);
  if (line_of_[vertex] == kNoIndex) line_of_[vertex] = line;
  one_each_ = line_of_[vertex] == line;
}

std::vector<Index> TextureOfVertex::take(std::size_t vertices) {
  if (!one_each_ || line_of_.empty()) return {};
  line_of_.resize(vertices, kNoIndex);
  return std::move(line_of_);
}

Result<ColorValues> read_obj_colors(std::string_view text,
                                    const std::vector<std::string_view>& last_words) {
  std::vector<double> values;
  values.reserve(3 * last_words.size());
  for (const std::string_view word : last_words) {
    std::string_view rest =
        text.substr(static_cast<std::size_t>(word.data() + word.size() - text.data()));
    for (int c = 0; c < 3; ++c) {
      const auto value = parse_real(next_word(rest));
      if (!value) return no_numbers("Colours");
      values.push_back(*value);
    }
  }
  return make_colors(values, 3);
}

Result<std::vector<float>> read_obj_texture_coordinates(std::string_view text,
                                                        const std::vector<Index>& line_of) {
  std::vector<double> lines;
  LineReader reader(text, Continuation::backslash);
  while (reader.next()) {
    std::string_view rest = reader.line();
    if (next_word(rest) != "vt") continue;
    const auto u = parse_real(next_word(rest));
    // A texture of one dimension has no v.
    const std::string_view second = next_word(rest);
    const auto v = second.empty() ? std::optional(0.0) : parse_real(second);
    if (!u || !v) return no_numbers("Texture coordinates");
    lines.insert(lines.end(), {*u, *v});
  }
  if (reader.error()) return *reader.error();
  std::vector<double> values;
  values.reserve(2 * line_of.size());
  for (const Index line : line_of) {
    const std::size_t at = 2 * std::size_t{line};
    const bool named = line != kNoIndex && at + 1 < lines.size();
    values.push_back(named ? lines[at] : 0.0);
    values.push_back(named ? lines[at + 1] : 0.0);
  }
  return make_texture_coordinates(values);
}

}  // namespace fairway
