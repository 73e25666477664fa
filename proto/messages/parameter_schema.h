#pragma once

#include <span>
#include <string_view>

#include "proto/messages/json.h"

namespace fairway {

/// What is told of a parameter beside what its reader says.
struct ParameterText {
  std::string_view path;  ///< names with '/' between them: "guards/unfold"
  std::string_view unit;  ///< "" where it has none
  std::string_view text;
};

/// Of every parameter one, in the order in which they are shown.
std::span<const ParameterText> parameter_texts();

/// The place of a parameter in a schema of parameters, through lists and alternatives; nullptr
/// where there is none.
const Json* schema_of(const Json& schema, std::string_view path);

/// JSON Schema (draft 2020-12) of parameter documents: bare_parameter_schema() with a description
/// and, where there is one, the unit as "x-unit" of every parameter.
Json parameter_schema();

}  // namespace fairway
