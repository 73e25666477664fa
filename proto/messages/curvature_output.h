#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// The per-vertex attributes that can be asked for, in the order they are written.
enum class CurvatureKind { k1, k2, mean, gaussian, predominant, dir1, dir2 };

/// "_CURVATURE_K1" …
std::string_view attribute_name(CurvatureKind kind);

/// "_FEATURE": 1 at feature vertices, else 0.
inline constexpr std::string_view kFeatureAttribute = "_FEATURE";

/// Whose lengths curvature is in: the mesh's own, or the scene's where a mesh has one uniform scale
/// in it. Directions are the mesh's own in both.
enum class CurvatureSpace { local, world };

/// Vertex colours of the predominant curvature.
struct ColorOptions {
  /// Curvature of the last colours of the map, which runs from −limit to limit. Automatic: what
  /// 95 % of a mesh's vertices stay below.
  std::optional<double> limit;
  bool replace = false;  ///< also where the file has colours
};

/// What is told of the curvature of a result.
struct CurvatureOutput {
  std::vector<CurvatureKind> kinds = {
      CurvatureKind::k1,          CurvatureKind::k2,   CurvatureKind::mean, CurvatureKind::gaussian,
      CurvatureKind::predominant, CurvatureKind::dir1, CurvatureKind::dir2};
  CurvatureSpace space = CurvatureSpace::local;
  std::optional<ColorOptions> colors;

  /// True where nobody has to compute it.
  bool none() const { return kinds.empty() && !colors; }
};

/// Takes "curvature", "curvature_space" and "colors" from a parameter document.
CurvatureOutput read_curvature_output(ObjectReader& reader);

/// Puts the same keys, every one stated, into a parameter document.
void add_curvature_output(const CurvatureOutput& output, Json& document);

}  // namespace fairway
