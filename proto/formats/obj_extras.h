#pragma once

#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/vertex_extras.h"

namespace fairway {

/// The line "vt" of every vertex of an OBJ, gathered corner by corner, as long as each has just
/// one.
class TextureOfVertex {
 public:
  /// A corner names a vertex of `known` so far, and a line "vt" or none (kNoIndex).
  void add(Index vertex, std::size_t known, Index line);

  /// Lines from 0, one per vertex; empty unless each of `vertices` has one, the same at all
  /// corners.
  std::vector<Index> take(std::size_t vertices);

 private:
  bool one_each_ = true;
  std::vector<Index> line_of_;
};

/// The three numbers behind each position. `last_words` are the words of the z coordinates, views
/// into `text`, on lines of six numbers. Errors: invalid_mesh (no numbers), unsupported_feature
/// (see make_colors()).
Result<ColorValues> read_obj_colors(std::string_view text,
                                    const std::vector<std::string_view>& last_words);

/// The numbers of the lines "vt" that `line_of` names for each vertex, 0 where it names none.
/// Error: invalid_mesh.
Result<std::vector<float>> read_obj_texture_coordinates(std::string_view text,
                                                        const std::vector<Index>& line_of);

}  // namespace fairway
