// The schema of the parameters against the strict parser.

#include "proto/messages/parameter_schema.h"

#include <limits>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "proto/messages/method_catalog.h"
#include "proto/messages/parameters.h"
#include "tests/messages/json_schema.h"

namespace fairway::test {
namespace {

/// Values at and around everything that a schema says of a value, and of every other type.
void add_values(const Json& schema, std::vector<Json>& out) {
  for (const char* wrong : {"null", "true", "false", "0", "1", "-1", "0.5", "\"x\"", "\"auto\"",
                            "[]", "[0]", "[\"x\"]", "[null]", "[{}]", "{}", "{\"x\":1}"}) {
    out.push_back(Json::parse(wrong));
  }
  const bool whole = schema.value("type", "") == "integer";
  for (const char* bound : {"minimum", "maximum"}) {
    if (!schema.contains(bound)) continue;
    const double value = schema[bound];
    const double out_of_it = std::string(bound) == "minimum" ? -1.0 : 1.0;
    out.emplace_back(value);
    out.emplace_back(whole ? value + out_of_it
                           : std::nextafter(value, out_of_it * std::numeric_limits<double>::max()));
    out.emplace_back(value - out_of_it);
    out.emplace_back(value - 0.5 * out_of_it);
  }
  for (const char* one : {"const", "default"}) {
    if (schema.contains(one)) out.push_back(schema[one]);
  }
  if (schema.contains("enum")) out.insert(out.end(), schema["enum"].begin(), schema["enum"].end());
  if (schema.contains("anyOf")) {
    for (const Json& alternative : schema["anyOf"]) add_values(alternative, out);
  }
}

std::vector<Json> values_around(const Json& schema);

/// Lists of one and two of the values of an item, and of the longest and a longer length.
void add_lists(const Json& schema, std::vector<Json>& out) {
  const std::vector<Json> items = values_around(schema["items"]);
  for (const Json& item : items) {
    out.push_back(Json::array({item}));
    out.push_back(Json::array({items.back(), item}));
  }
  if (!schema.contains("maxItems")) return;
  const std::size_t most = schema["maxItems"];
  out.emplace_back(Json::array_t(most, 0));
  out.emplace_back(Json::array_t(most + 1, 0));
}

/// Objects with one member, with the required ones beside it, and without each required one.
void add_objects(const Json& schema, std::vector<Json>& out) {
  Json least = Json::object();
  for (const Json& key : schema.value("required", Json::array())) {
    const Json& member = schema["properties"][key.get<std::string>()];
    least[key.get<std::string>()] = member["type"] == "array" ? Json::array({0}) : Json(0);
  }
  out.push_back(least);
  Json unknown = least;
  unknown["no_such_key"] = 1;
  out.push_back(unknown);
  for (const auto& [key, member] : schema["properties"].items()) {
    Json without = least;
    without.erase(key);
    out.push_back(without);
    for (const Json& value : values_around(member)) {
      Json one = least;
      one[key] = value;
      out.push_back(one);
    }
  }
}

void add_composed(const Json& schema, std::vector<Json>& out) {
  if (schema.contains("items")) add_lists(schema, out);
  if (schema.contains("properties")) add_objects(schema, out);
  if (!schema.contains("anyOf")) return;
  for (const Json& alternative : schema["anyOf"]) add_composed(alternative, out);
}

std::vector<Json> values_around(const Json& schema) {
  std::vector<Json> out;
  add_values(schema, out);
  add_composed(schema, out);
  return out;
}

struct Verdicts {
  std::size_t accepted = 0;
  std::size_t refused = 0;
};

/// The parser and the schema must say the same of a document.
void compare(const Json& document, const Json& schema, Verdicts& verdicts) {
  const auto parsed = parse_parameters(dump_json(document));
  const std::string fault = schema_fault(document, schema, schema);
  ++(parsed ? verdicts.accepted : verdicts.refused);
  if (static_cast<bool>(parsed) == fault.empty()) return;
  const std::string text = dump_json(document).substr(0, 300);
  CAPTURE(text, fault);
  INFO((parsed ? std::string("the parser accepts it") : parsed.error().message));
  CHECK(static_cast<bool>(parsed) == fault.empty());
}

std::set<std::string> paths_of(const Json& document, const std::string& before = "") {
  std::set<std::string> out;
  for (const auto& [key, value] : document.items()) {
    out.insert(before + key);
    if (value.is_object()) out.merge(paths_of(value, before + key + "/"));
    if (value.is_array() && !value.empty() && value[0].is_object()) {
      out.merge(paths_of(value[0], before + key + "/"));
    }
  }
  return out;
}

/// Paths of all properties of a schema.
void add_schema_paths(const Json& schema, const std::string& before, std::set<std::string>& out) {
  if (schema.contains("properties")) {
    for (const auto& [key, member] : schema["properties"].items()) {
      out.insert(before + key);
      add_schema_paths(member, before + key + "/", out);
    }
  }
  if (schema.contains("items")) add_schema_paths(schema["items"], before, out);
  if (!schema.contains("anyOf")) return;
  for (const Json& alternative : schema["anyOf"]) add_schema_paths(alternative, before, out);
}

std::set<std::string> schema_paths() {
  std::set<std::string> out;
  add_schema_paths(parameter_schema(), "", out);
  return out;
}

}  // namespace

TEST_CASE("the parser accepts exactly what the schema of the parameters accepts") {
  const Json schema = parameter_schema();
  Verdicts verdicts;
  for (const auto& [key, property] : schema["properties"].items()) {
    for (const Json& value : values_around(property)) {
      compare(Json{{key, value}}, schema, verdicts);
    }
  }
  CHECK(verdicts.accepted > 150);
  CHECK(verdicts.refused > 500);
}

TEST_CASE("the schema knows which parameters exclude each other") {
  const Json schema = parameter_schema();
  Verdicts verdicts;
  for (const char* text :
       {R"({"lambda":1,"feature_angle":20})", R"({"lambda":"auto","feature_angle":20})",
        R"({"lambda":1,"feature_angle":"auto"})", R"({"curvature":["k1","_CURVATURE_K1"]})",
        R"({"curvature":["k1","_CURVATURE_K2"]})", R"({"preset":"cad","lambda":0.5})",
        R"({"preset":"cad","guards":{"unfold":1}})", R"({"preset":"cad","stepz":1})"}) {
    compare(Json::parse(text), schema, verdicts);
  }
  CHECK(verdicts.accepted == 4);
  CHECK(verdicts.refused == 4);
}

TEST_CASE(
    "every key of a stated document is in the schema, and every key of the schema is stated") {
  std::set<std::string> stated;
  for (const char* text : {"{}", R"({"lambda":1,"meshes":[0],"nodes":[0],"colors":true})",
                           R"({"fixed_vertices":[{"mesh":0,"vertices":[1]}]})"}) {
    const auto parameters = parse_parameters(text);
    REQUIRE(parameters);
    const Json document = parameters_document(*parameters);
    CHECK(schema_fault(document, parameter_schema(), parameter_schema()).empty());
    stated.merge(paths_of(document));
  }
  stated.insert("output/format");  // a spelling that is taken and never stated
  CHECK(stated == schema_paths());
}

TEST_CASE("every parameter has one text, and every text its parameter") {
  std::set<std::string> texts;
  for (const ParameterText& text : parameter_texts()) {
    CAPTURE(text.path);
    CHECK(texts.insert(std::string(text.path)).second);
    CHECK(schema_of(parameter_schema(), text.path) != nullptr);
  }
  CHECK(texts == schema_paths());
  const Json schema = parameter_schema();
  CHECK((*schema_of(schema, "step_size"))["x-unit"] == "squared mean edge lengths");
  CHECK((*schema_of(schema, "guards/min_component"))["default"] == 12);
  CHECK(schema_of(schema, "guards/nothing") == nullptr);
}

TEST_CASE("the defaults of the schema are the values of an empty document") {
  const Json stated = parameters_document(*parse_parameters("{}"));
  const Json schema = parameter_schema();
  for (const auto& [key, value] : stated.items()) {
    CAPTURE(key);
    const Json& property = schema["properties"][key];
    if (value.is_object()) {
      for (const auto& [member, inner] : value.items()) {
        CHECK(property["properties"][member]["default"] == inner);
      }
    } else {
      CHECK(property["default"] == value);
    }
  }
}

TEST_CASE("a preset gives the values that are not stated") {
  const auto resolved = [](const std::string& text) {
    const auto parameters = parse_parameters(text);
    REQUIRE(parameters);
    return parameters_document(*parameters);
  };
  CHECK(resolved("{}")["preset"] == "auto");
  for (const Preset preset : kPresets) {
    const std::string name(name_of(preset));
    CAPTURE(name);
    Json values = values_of(preset);
    Json expected = resolved(dump_json(values));
    expected["preset"] = name;
    const Json by_name = resolved(R"({"preset":")" + name + "\"}");
    CHECK(by_name == expected);
    CHECK(resolved(dump_json(by_name)) == by_name);
    CHECK(std::string(description_of(preset)).ends_with("."));
  }
  CHECK(resolved(R"({"preset":"cad"})")["surface"] == "sharp");
  CHECK(resolved(R"({"preset":"cad","surface":"smooth"})")["surface"] == "smooth");
  CHECK(resolved(R"({"preset":"gentle","strength":"auto"})")["strength"] == "auto");
  // A flow that is stated has no use for what a preset says of the variational method.
  const Json flow = resolved(R"({"preset":"gentle","method":"anisotropic"})");
  CHECK(flow["method"] == "anisotropic");
  CHECK_FALSE(flow.contains("strength"));
}

TEST_CASE("an unknown preset, and a wrong value beside one, are refused with their pointers") {
  const auto pointer = [](const std::string& text) {
    const auto parameters = parse_parameters(text);
    REQUIRE_FALSE(parameters);
    CHECK(parameters.error().code == ErrorCode::invalid_parameters);
    return parameters.error().pointer;
  };
  CHECK(pointer(R"({"preset":"metal"})") == "/preset");
  CHECK(pointer(R"({"preset":3})") == "/preset");
  CHECK(pointer(R"({"preset":"scan","guards":3})") == "/guards");
  CHECK(pointer(R"({"preset":"scan","guards":{"unfold":3}})") == "/guards/unfold");
}

TEST_CASE("the document of the methods has every method, preset and parameter") {
  const Json document = methods_document();
  std::set<std::string> names;
  for (const Json& method : document["methods"]) {
    names.insert(method["name"]);
    for (const char* text : {"equation", "good_for", "choose_when"}) {
      CHECK(method[text].get<std::string>().size() > 5);
    }
  }
  const Json& listed = document["parameters"]["properties"]["method"]["enum"];
  CHECK(names == std::set<std::string>(listed.begin(), listed.end()));
  CHECK(document["methods"][0]["name"] ==
        document["parameters"]["properties"]["method"]["default"]);
  REQUIRE(document["presets"].size() == kPresets.size());
  const Json& presets = document["parameters"]["properties"]["preset"]["enum"];
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    CHECK(document["presets"][i]["name"] == presets[i]);
  }
}

}  // namespace fairway::test
