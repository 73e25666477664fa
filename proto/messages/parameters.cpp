// The parameter document: strict JSON in, checked values out, and back.

#include "proto/messages/parameters.h"

#include <array>
#include <span>

#include "proto/messages/flow_parameters.h"
#include "proto/messages/object_reader.h"

namespace fairway {
namespace {

constexpr std::array<Named<Welding>, 2> kWeldings = {{
    {"position", Welding::position},
    {"none", Welding::none},
}};

constexpr std::array<Named<Format>, 6> kOutputs = {{{"glb", Format::glb},
                                                    {"gltf", Format::gltf},
                                                    {"drc", Format::drc},
                                                    {"ply", Format::ply},
                                                    {"obj", Format::obj},
                                                    {"stl", Format::stl}}};

std::optional<Format> read_output(ObjectReader& reader) {
  constexpr std::span<const Named<Format>> kNames(kOutputs);
  std::optional<Format> format;
  reader.object_or(
      "output", [&](ObjectReader& output) { output.choice_or_auto("format", kNames, format); },
      [&] { reader.choice_or_auto("output", kNames, format); });
  return format;
}

Parameters read_parameters(ObjectReader& reader) {
  Parameters parameters;
  reader.choice("preset", preset_names(), parameters.preset);
  parameters.flow = read_flow(reader);
  parameters.curvature = read_curvature_output(reader);
  reader.boolean("features", parameters.flow.find_features);
  parameters.selection = read_selection(reader);
  parameters.fixed_vertices = read_fixed_vertices(reader);
  reader.choice("weld", std::span<const Named<Welding>>(kWeldings), parameters.welding);
  parameters.output = read_output(reader);
  parameters.encoding = read_encoding(reader);
  return parameters;
}

}  // namespace

Result<Parameters> parse_parameters(std::string_view text) {
  if (text.empty()) return Parameters{};
  Result<Json> json = parse_json(text);
  if (!json) {
    return Error{ErrorCode::malformed_parameters,
                 "The parameter document cannot be parsed: " + json.error().message};
  }
  if (!json->is_object()) {
    return Error{ErrorCode::invalid_parameters,
                 "The parameter document must be a JSON object, for example {}."};
  }
  choose_method(*json);
  fill_from_preset(*json);
  ObjectReader reader(*json, "");
  Parameters parameters = read_parameters(reader);
  reader.refuse_unknown_keys();
  if (reader.error()) return *reader.error();
  if (std::optional<Error> foreign = refuse_foreign(*json)) return *std::move(foreign);
  return parameters;
}

Json bare_parameter_schema() {
  ObjectReader reader = ObjectReader::describing();
  [[maybe_unused]] const Parameters read = read_parameters(reader);
  return reader.schema();
}

Json parameters_document(const Parameters& parameters) {
  Json document = {{"preset", name_of(parameters.preset)}};
  add_flow(parameters.flow, document);
  add_selection(parameters.selection, document);
  add_fixed_vertices(parameters.fixed_vertices, document);
  document["weld"] = kWeldings[static_cast<std::size_t>(parameters.welding)].name;
  add_curvature_output(parameters.curvature, document);
  document["features"] = parameters.flow.find_features;
  document["output"] = parameters.output ? Json(name_of(*parameters.output)) : Json("auto");
  add_encoding(parameters.encoding, document);
  return document;
}

}  // namespace fairway
