#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/flow_options.h"
#include "core/result.h"
#include "proto/messages/encoding.h"
#include "proto/messages/format.h"
#include "proto/messages/json.h"

namespace fairway {

/// The per-vertex attributes that can be asked for, in the order they are written.
enum class CurvatureKind { k1, k2, mean, gaussian, predominant, dir1, dir2 };

/// "_CURVATURE_K1" …
std::string_view attribute_name(CurvatureKind kind);

/// "_FEATURE": 1 at feature vertices, else 0.
inline constexpr std::string_view kFeatureAttribute = "_FEATURE";

/// Vertices that do not move, as a client names them: elements, from 0, of the POSITION accessor of
/// a triangle primitive. Without a mesh: of the only POSITION accessor there is, or of a Draco
/// mesh.
struct FixedVertices {
  struct Place {
    std::size_t mesh = 0;
    std::size_t primitive = 0;
  };
  std::optional<Place> place;
  std::vector<Index> vertices;
};

/// Most fixed vertices of a request, all lists together.
inline constexpr std::size_t kMostFixedVertices = 100'000;

/// A whole request: the flow, the attributes, the output.
struct Parameters {
  FlowOptions flow;  ///< its `fixed_vertices` are empty: which they are depends on the file
  std::vector<FixedVertices> fixed_vertices;  ///< one without a place, or any number with one
  std::vector<CurvatureKind> curvature = {
      CurvatureKind::k1,          CurvatureKind::k2,   CurvatureKind::mean, CurvatureKind::gaussian,
      CurvatureKind::predominant, CurvatureKind::dir1, CurvatureKind::dir2};
  std::optional<Format> output;  ///< automatic: the format that came
  Encoding encoding;
};

/// Parses and checks a parameter document; empty text and {} are all automatic choices.
/// Errors: malformed_parameters (not JSON), invalid_parameters, with the pointer of the culprit.
Result<Parameters> parse_parameters(std::string_view text);

/// The document that parse_parameters() reads back as the same parameters, every key stated.
Json parameters_document(const Parameters& parameters);

}  // namespace fairway
