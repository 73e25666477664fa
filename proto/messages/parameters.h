#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/flow_options.h"
#include "core/result.h"
#include "proto/messages/curvature_output.h"
#include "proto/messages/encoding.h"
#include "proto/messages/format.h"
#include "proto/messages/json.h"
#include "proto/messages/part_selection.h"
#include "proto/messages/presets.h"

namespace fairway {

/// Which vertices are one when it is computed with a surface: those at equal positions, or none but
/// an element that the file itself uses several times.
enum class Welding { position, none };

/// A whole request: the flow, the attributes, the output.
struct Parameters {
  Preset preset = Preset::automatic;  ///< where the values not stated came from
  FlowOptions flow;  ///< its `fixed_vertices` are empty: which they are depends on the file
  MeshSelection selection;
  std::vector<FixedVertices> fixed_vertices;  ///< one without a place, or any number with one
  Welding welding = Welding::position;
  CurvatureOutput curvature;
  std::optional<Format> output;  ///< automatic: the format that came
  Encoding encoding;
};

/// Parses and checks a parameter document; empty text and {} are all automatic choices. What it
/// does not state has the value of its preset.
/// Errors: malformed_parameters (not JSON), invalid_parameters, with the pointer of the culprit.
Result<Parameters> parse_parameters(std::string_view text);

/// The document that parse_parameters() reads back as the same parameters, every key stated;
/// "meshes" and "nodes" only where they select something.
Json parameters_document(const Parameters& parameters);

/// JSON Schema (draft 2020-12) of parameter documents, written down by the code that reads them:
/// accepts what parse_parameters() accepts, but for the sum of all lists of fixed vertices. Has no
/// descriptions yet, see describe_parameters().
Json bare_parameter_schema();

}  // namespace fairway
