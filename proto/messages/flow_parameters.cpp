// What steers a flow, as a part of the parameter document.

#include "proto/messages/flow_parameters.h"

#include <algorithm>
#include <array>

namespace fairway {
namespace {

constexpr std::array<Named<Method>, 6> kMethods = {{
    {"variational", Method::variational},
    {"anisotropic_prescribed", Method::anisotropic_prescribed},
    {"anisotropic", Method::anisotropic},
    {"prescribed", Method::prescribed},
    {"mean_curvature", Method::mean_curvature},
    {"none", Method::none},
}};
constexpr std::array<Named<NoiseKind>, 3> kNoises = {{
    {"auto", NoiseKind::automatic},
    {"white", NoiseKind::white},
    {"correlated", NoiseKind::correlated},
}};
constexpr std::array<Named<SurfaceKind>, 3> kSurfaces = {{
    {"auto", SurfaceKind::automatic},
    {"sharp", SurfaceKind::sharp},
    {"smooth", SurfaceKind::smooth},
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

/// Of the variational method only.
constexpr auto kVariationalKeys = std::to_array<const char*>({"strength", "noise", "surface"});
/// Of the flows only.
constexpr auto kFlowKeys =
    std::to_array<const char*>({"integration", "mass", "curvature_measure", "steps", "step_size",
                                "transition", "curvature_smoothing", "conventions", "guards"});
/// Of the flows, and for the vertices that `features` marks of every method.
constexpr auto kThresholdKeys = std::to_array<const char*>({"feature_angle", "lambda"});
constexpr const char* kFlowOfKeys = "anisotropic_prescribed";

/// The first of the keys that has a value other than "auto".
const char* first_of(std::span<const char* const> keys, const Json& document) {
  const auto stated = std::find_if(keys.begin(), keys.end(), [&](const char* key) {
    const auto found = document.find(key);
    return found != document.end() && *found != "auto";
  });
  return stated == keys.end() ? nullptr : *stated;
}

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

void choose_method(Json& document) {
  if (document.contains("method")) return;
  if (first_of(kFlowKeys, document) == nullptr && first_of(kThresholdKeys, document) == nullptr) {
    return;
  }
  document["method"] = kFlowOfKeys;
}

bool states_flow(const Json& document) {
  const auto method = document.find("method");
  return method != document.end() && *method != "variational";
}

void drop_variational(Json& values) {
  for (const char* key : kVariationalKeys) values.erase(key);
}

std::optional<Error> refuse_foreign(const Json& document) {
  if (states_flow(document)) {
    const char* key = first_of(kVariationalKeys, document);
    if (key == nullptr) return std::nullopt;
    return Error{ErrorCode::invalid_parameters,
                 std::string(key) +
                     " belongs to the variational method; leave it out, or leave out the flow "
                     "and what belongs to flows.",
                 std::string("/") + key};
  }
  const char* key = first_of(kFlowKeys, document);
  if (key == nullptr) return std::nullopt;
  return Error{ErrorCode::invalid_parameters,
               std::string(key) +
                   " belongs to the flows; leave it out, or state one of them, such "
                   "as \"method\": \"anisotropic_prescribed\".",
               std::string("/") + key};
}

FlowOptions read_flow(ObjectReader& reader) {
  FlowOptions flow;
  reader.choice("method", std::span<const Named<Method>>(kMethods), flow.method);
  reader.number_or_auto("strength", {0.0, 1.0}, flow.strength);
  reader.choice("noise", std::span<const Named<NoiseKind>>(kNoises), flow.noise);
  reader.choice("surface", std::span<const Named<SurfaceKind>>(kSurfaces), flow.surface);
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
  reader.not_both("lambda", "feature_angle");
  return flow;
}

void add_flow(const FlowOptions& flow, Json& document) {
  document["method"] = name_in(kMethods, flow.method);
  document["boundary"] = name_in(kBoundaries, flow.boundary);
  if (flow.lambda) {
    document["lambda"] = *flow.lambda;
  } else {
    document["feature_angle"] = or_auto(flow.feature_angle);
  }
  if (flow.method == Method::variational) {
    document["strength"] = or_auto(flow.strength);
    document["noise"] = name_in(kNoises, flow.noise);
    document["surface"] = name_in(kSurfaces, flow.surface);
    return;
  }
  const Json of_flows = {{"integration", name_in(kIntegrations, flow.integration)},
                         {"mass", flow.mass ? Json(name_in(kMasses, *flow.mass)) : Json("auto")},
                         {"curvature_measure", name_in(kMeasures, flow.measure)},
                         {"steps", or_auto(flow.steps)},
                         {"step_size", or_auto(flow.step_size)},
                         {"transition", flow.transition},
                         {"curvature_smoothing",
                          {{"passes", flow.curvature_smoothing.passes},
                           {"fraction", flow.curvature_smoothing.fraction}}},
                         {"conventions", name_in(kConventions, flow.conventions)},
                         {"guards",
                          {{"unfold", flow.guards.unfold},
                           {"min_component", flow.guards.min_component},
                           {"local_step", flow.guards.local_step}}}};
  document.update(of_flows);
}

}  // namespace fairway
