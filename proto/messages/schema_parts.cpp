// Pieces of JSON Schema, draft 2020-12:
// https://json-schema.org/draft/2020-12/json-schema-validation

#include "proto/messages/schema_parts.h"

#include <string>
#include <utility>

namespace fairway::schema_parts {

Json object() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

Json number(double low, double high) {
  return {{"type", "number"}, {"minimum", low}, {"maximum", high}};
}

Json integer(int low, int high) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}};
}

Json with_default(Json schema, Json value) {
  schema["default"] = std::move(value);
  return schema;
}

Json or_constant(Json schema, const Json& constant, const Json& value) {
  Json constant_schema{{"const", constant}};
  return {{"anyOf", Json::array({std::move(schema), std::move(constant_schema)})},
          {"default", value}};
}

Json either(Json first, Json second) {
  Json value;
  if (first.contains("default")) {
    value = std::move(first["default"]);
    first.erase("default");
  }
  Json out{{"anyOf", Json::array({std::move(first), std::move(second)})}};
  if (!value.is_null()) out["default"] = std::move(value);
  return out;
}

Json indices(std::size_t least, std::size_t most, int last) {
  Json out{{"type", "array"}, {"items", integer(0, last)}, {"maxItems", most}};
  if (least > 0) {
    out["minItems"] = least;
  } else {
    out["default"] = Json::array();
  }
  return out;
}

Json names(std::span<const std::string_view> names, std::span<const std::string_view> aliases,
           const std::vector<std::size_t>& chosen) {
  Json all = Json::array();
  for (const std::string_view name : names) all.push_back(name);
  Json rules = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    all.push_back(aliases[i]);
    // uniqueItems does not know that two spellings are one name.
    Json one{{"contains", {{"const", names[i]}}}};
    Json other{{"contains", {{"const", aliases[i]}}}};
    rules.push_back({{"not", {{"allOf", Json::array({std::move(one), std::move(other)})}}}});
  }
  Json value = Json::array();
  for (const std::size_t which : chosen) value.push_back(names[which]);
  return {{"type", "array"},
          {"items", {{"type", "string"}, {"enum", std::move(all)}}},
          {"uniqueItems", true},
          {"allOf", std::move(rules)},
          {"default", std::move(value)}};
}

Json both_numbers(std::string_view key, std::string_view other) {
  const Json number{{"type", "number"}};
  return {{"required", Json::array({key, other})},
          {"properties", {{std::string(key), number}, {std::string(other), number}}}};
}

}  // namespace fairway::schema_parts
