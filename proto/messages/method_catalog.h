#pragma once

#include <span>
#include <string_view>

#include "core/flow_options.h"
#include "proto/messages/json.h"

namespace fairway {

/// What is told of a flow.
struct MethodText {
  Method method;
  std::string_view name;
  std::string_view equation;  ///< of a vertex p, and its number in the paper
  std::string_view good_for;
  std::string_view choose_when;
};

/// Of every method one, the default first.
std::span<const MethodText> method_texts();

/// The document of GET /v1/methods and `fairway methods --json`: {"methods": [{name, equation,
/// good_for, choose_when}], "presets": [{name, description, parameters}], "parameters": the schema
/// of parameter_schema()}.
Json methods_document();

}  // namespace fairway
