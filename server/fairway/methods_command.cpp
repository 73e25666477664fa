// `fairway methods`: the flows, presets and parameters, as a table or as JSON.

#include <string>

#include <fmt/format.h>

#include "proto/messages/method_catalog.h"
#include "proto/messages/parameter_schema.h"
#include "proto/messages/presets.h"
#include "server/fairway/commands.h"

namespace fairway {
namespace {

/// Text without quotes, fractions without needless digits.
std::string shown(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : dump_json(value);
}

/// What a schema takes, in a few words.
std::string values_of_schema(const Json& schema) {
  if (schema.contains("anyOf")) {
    std::string out;
    for (const Json& one : schema["anyOf"]) {
      out += (out.empty() ? "" : ", ") + values_of_schema(one);
    }
    return out;
  }
  if (schema.contains("const")) return shown(schema["const"]);
  if (schema.contains("enum")) {
    std::string out;
    for (const Json& name : schema["enum"]) out += (out.empty() ? "" : ", ") + shown(name);
    return out;
  }
  std::string type = schema["type"];
  if (schema.contains("minimum")) {
    return fmt::format("{} to {}", shown(schema["minimum"]), shown(schema["maximum"]));
  }
  if (type == "boolean") return "true, false";
  if (type == "array") return "list of " + values_of_schema(schema["items"]);
  return type;
}

void print_parameters() {
  const Json schema = parameter_schema();
  for (const ParameterText& text : parameter_texts()) {
    const Json& property = *schema_of(schema, text.path);
    const std::string unit = text.unit.empty() ? "" : fmt::format(" ({})", text.unit);
    fmt::print("  {}: {}{}", text.path, values_of_schema(property), unit);
    if (property.contains("default")) fmt::print("; default {}", shown(property["default"]));
    fmt::print("\n      {}\n", text.text);
  }
}

void print_tables() {
  fmt::print("Methods\n");
  for (const MethodText& method : method_texts()) {
    fmt::print("  {:<24}{}\n      {}\n      {}\n", method.name, method.equation, method.good_for,
               method.choose_when);
  }
  fmt::print("\nPresets\n");
  for (const Preset preset : kPresets) {
    fmt::print("  {:<10}{}\n      {}\n", name_of(preset), dump_json(values_of(preset)),
               description_of(preset));
  }
  fmt::print("\nParameters\n");
  print_parameters();
}

}  // namespace

Result<void> run(const MethodsCommand& command) {
  if (command.json) {
    fmt::print("{}\n", dump_json(methods_document()));
  } else {
    print_tables();
  }
  return {};
}

}  // namespace fairway
