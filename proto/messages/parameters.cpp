// The parameter document: strict JSON in, checked values out, and back.

#include "proto/messages/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/object_reader.h"

namespace fairway {
namespace {

constexpr std::array<std::string_view, 7> kCurvatureNames = {
    "k1", "k2", "mean", "gaussian", "predominant", "dir1", "dir2"};
constexpr std::array<std::string_view, 7> kAttributeNames = {
    "_CURVATURE_K1",          "_CURVATURE_K2",   "_CURVATURE_MEAN", "_CURVATURE_GAUSSIAN",
    "_CURVATURE_PREDOMINANT", "_CURVATURE_DIR1", "_CURVATURE_DIR2"};

constexpr std::array<Named<Method>, 5> kMethods = {{
    {"anisotropic_prescribed", Method::anisotropic_prescribed},
    {"anisotropic", Method::anisotropic},
    {"prescribed", Method::prescribed},
    {"mean_curvature", Method::mean_curvature},
    {"none", Method::none},
}};
constexpr std::array<Named<Integration>, 2> kIntegrations = {{
    {"explicit", Integration::explicit_euler},
    {"semi_implicit", Integration::semi_implicit},
}};
constexpr std::array<Named<Mass>, 2> kMasses = {{
    {"lumped", Mass::lumped},
    {"full", Mass::full},
}};
constexpr std::array<Named<CurvatureMeasure>, 3> kMeasures = {{
    {"length", CurvatureMeasure::length},
    {"project", CurvatureMeasure::project},
    {"mass", CurvatureMeasure::mass},
}};
constexpr std::array<Named<Boundary>, 2> kBoundaries = {{
    {"free", Boundary::free},
    {"fixed", Boundary::fixed},
}};
constexpr std::array<Named<Conventions>, 2> kConventions = {{
    {"recommended", Conventions::recommended},
    {"paper", Conventions::paper},
}};

CurvatureSmoothing read_smoothing(ObjectReader& parent) {
  CurvatureSmoothing smoothing;
  ObjectReader reader = parent.object("curvature_smoothing");
  reader.integer("passes", 0, 100, smoothing.passes);
  reader.number("fraction", {0.0, 1.0}, smoothing.fraction);
  parent.take_error(reader);
  return smoothing;
}

Guards read_guards(ObjectReader& parent) {
  Guards guards;
  ObjectReader reader = parent.object("guards");
  reader.boolean("unfold", guards.unfold);
  reader.integer_or_false("min_component", 0, 1'000'000, guards.min_component);
  reader.boolean("local_step", guards.local_step);
  parent.take_error(reader);
  return guards;
}

std::vector<CurvatureKind> read_curvature(ObjectReader& reader) {
  std::vector<CurvatureKind> kinds;
  reader.strings("curvature", [&kinds](std::string_view name) -> std::string {
    for (std::size_t i = 0; i < kCurvatureNames.size(); ++i) {
      if (name != kCurvatureNames[i] && name != kAttributeNames[i]) continue;
      const auto kind = static_cast<CurvatureKind>(i);
      if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return "is named twice";
      kinds.push_back(kind);
      return {};
    }
    return fmt::format("must be one of {}", fmt::join(kCurvatureNames, ", "));
  });
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

FixedVertices read_fixed_at_place(ObjectReader& reader, std::size_t most) {
  constexpr int kLast = 1'000'000'000;
  int mesh = 0;
  int primitive = 0;
  FixedVertices fixed;
  reader.require("mesh");
  reader.integer("mesh", 0, kLast, mesh);
  reader.integer("primitive", 0, kLast, primitive);
  reader.require("vertices");
  reader.indices("vertices", most, fixed.vertices);
  fixed.place = {static_cast<std::size_t>(mesh), static_cast<std::size_t>(primitive)};
  return fixed;
}

std::vector<FixedVertices> read_fixed_vertices(ObjectReader& reader) {
  constexpr std::string_view kKey = "fixed_vertices";
  std::vector<FixedVertices> out;
  if (reader.holds_objects(kKey)) {
    std::size_t left = kMostFixedVertices;
    reader.objects(kKey, [&](ObjectReader& item) {
      out.push_back(read_fixed_at_place(item, left));
      left -= out.back().vertices.size();
    });
  } else {
    FixedVertices fixed;
    reader.indices(kKey, kMostFixedVertices, fixed.vertices);
    if (!fixed.vertices.empty()) out.push_back(std::move(fixed));
  }
  return out;
}

Json fixed_vertices_document(const std::vector<FixedVertices>& fixed) {
  if (fixed.size() == 1 && !fixed.front().place) return fixed.front().vertices;
  Json list = Json::array();
  for (const FixedVertices& item : fixed) {
    list.push_back({{"mesh", item.place->mesh},
                    {"primitive", item.place->primitive},
                    {"vertices", item.vertices}});
  }
  return list;
}

std::optional<Format> read_output(ObjectReader& reader) {
  constexpr std::array<Named<Format>, 6> kOutputs = {{{"glb", Format::glb},
                                                      {"gltf", Format::gltf},
                                                      {"drc", Format::drc},
                                                      {"ply", Format::ply},
                                                      {"obj", Format::obj},
                                                      {"stl", Format::stl}}};
  std::optional<Format> format;
  if (reader.holds_object("output")) {
    ObjectReader output = reader.object("output");
    output.choice_or_auto("format", std::span<const Named<Format>>(kOutputs), format);
    reader.take_error(output);
  } else {
    reader.choice_or_auto("output", std::span<const Named<Format>>(kOutputs), format);
  }
  return format;
}

FlowOptions read_flow(ObjectReader& reader) {
  FlowOptions flow;
  reader.choice("method", std::span<const Named<Method>>(kMethods), flow.method);
  reader.choice("integration", std::span<const Named<Integration>>(kIntegrations),
                flow.integration);
  reader.choice_or_auto("mass", std::span<const Named<Mass>>(kMasses), flow.mass);
  reader.choice("curvature_measure", std::span<const Named<CurvatureMeasure>>(kMeasures),
                flow.measure);
  reader.integer_or_auto("steps", 0, 10'000, flow.steps);
  reader.number_or_auto("step_size", {1e-9, 1e3}, flow.step_size);
  reader.number_or_auto("feature_angle", {0.01, 180.0}, flow.feature_angle);
  reader.number_or_auto("lambda", {1e-300, 1e300}, flow.lambda);
  reader.number("transition", {0.0, 1e9}, flow.transition);
  flow.curvature_smoothing = read_smoothing(reader);
  reader.choice("boundary", std::span<const Named<Boundary>>(kBoundaries), flow.boundary);
  reader.choice("conventions", std::span<const Named<Conventions>>(kConventions), flow.conventions);
  flow.guards = read_guards(reader);
  if (flow.lambda && flow.feature_angle) {
    reader.fail("lambda", "stands together with feature_angle; give one of the two");
  }
  return flow;
}

Json or_auto(const auto& value) {
  return value ? Json(*value) : Json("auto");
}

template <class T, std::size_t N>
std::string_view name_in(const std::array<Named<T>, N>& names, T value) {
  return std::find_if(names.begin(), names.end(),
                      [value](const Named<T>& named) { return named.value == value; })
      ->name;
}

}  // namespace

std::string_view attribute_name(CurvatureKind kind) {
  return kAttributeNames[static_cast<std::size_t>(kind)];
}

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
  Parameters parameters;
  ObjectReader reader(*json, "");
  parameters.flow = read_flow(reader);
  std::vector<CurvatureKind> curvature = read_curvature(reader);
  if (reader.holds("curvature")) parameters.curvature = std::move(curvature);
  reader.boolean("features", parameters.flow.find_features);
  parameters.fixed_vertices = read_fixed_vertices(reader);
  parameters.output = read_output(reader);
  parameters.encoding = read_encoding(reader);
  reader.refuse_unknown_keys();
  if (reader.error()) return *reader.error();
  return parameters;
}

Json parameters_document(const Parameters& parameters) {
  const FlowOptions& flow = parameters.flow;
  Json curvature = Json::array();
  for (const CurvatureKind kind : parameters.curvature) {
    curvature.push_back(kCurvatureNames[static_cast<std::size_t>(kind)]);
  }
  Json document = {{"method", name_in(kMethods, flow.method)},
                   {"integration", name_in(kIntegrations, flow.integration)},
                   {"mass", flow.mass ? Json(name_in(kMasses, *flow.mass)) : Json("auto")},
                   {"curvature_measure", name_in(kMeasures, flow.measure)},
                   {"steps", or_auto(flow.steps)},
                   {"step_size", or_auto(flow.step_size)}};
  if (flow.lambda) {
    document["lambda"] = *flow.lambda;
  } else {
    document["feature_angle"] = or_auto(flow.feature_angle);
  }
  document["transition"] = flow.transition;
  document["curvature_smoothing"] = {{"passes", flow.curvature_smoothing.passes},
                                     {"fraction", flow.curvature_smoothing.fraction}};
  document["boundary"] = name_in(kBoundaries, flow.boundary);
  document["conventions"] = name_in(kConventions, flow.conventions);
  document["guards"] = {{"unfold", flow.guards.unfold},
                        {"min_component", flow.guards.min_component},
                        {"local_step", flow.guards.local_step}};
  document["fixed_vertices"] = fixed_vertices_document(parameters.fixed_vertices);
  document["curvature"] = std::move(curvature);
  document["features"] = flow.find_features;
  document["output"] = parameters.output ? Json(name_of(*parameters.output)) : Json("auto");
  add_encoding(parameters.encoding, document);
  return document;
}

}  // namespace fairway
