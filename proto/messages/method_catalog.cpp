// The flows, presets and parameters in one document. Equations: core/EQUATIONS.md.

#include "proto/messages/method_catalog.h"

#include <array>

#include "proto/messages/parameter_schema.h"
#include "proto/messages/presets.h"

namespace fairway {
namespace {

constexpr auto kMethods = std::to_array<MethodText>({
    {Method::variational, "variational",
     "min sum c |x - x0|^2 + mu sum w |D x - delta N|^2 for growing mu, the least by "
     "cross-validation",
     "Any surface with noise: parts with sharp and curved edges, scans, bodies.",
     "By default. It finds all of its numbers from the mesh and keeps edges, corners and volume."},
    {Method::anisotropic_prescribed, "anisotropic_prescribed",
     "dp/dt = -(1/M) (H_A - f V_A), eq. (11)",
     "Sharp edges and curved creases on surfaces whose curvature is to stay: CAD parts, machined "
     "and moulded objects.",
     "Where the paper's own flow is wanted, step by step. It keeps volume, curved creases and "
     "corners."},
    {Method::anisotropic, "anisotropic", "dp/dt = -(1/M) H_A, eqs. (7), (8)",
     "Straight creases between smooth or flat regions; natural shapes with much fine relief.",
     "Where less noise is worth a slight loss of volume, or the surface is organic."},
    {Method::prescribed, "prescribed", "dp/dt = -(1/M) (H - f grad vol), eq. (10)",
     "Smooth closed shapes without any edge.",
     "Where nothing is sharp and the volume is to stay. It rounds edges."},
    {Method::mean_curvature, "mean_curvature", "dp/dt = -(1/M) H, eq. (8) with w = 1",
     "Plain smoothing, as a reference.",
     "To compare with, or to round edges on purpose. It shrinks the surface."},
    {Method::none, "none", "dp/dt = 0", "Curvature and feature attributes of the mesh as it is.",
     "Where nothing is to move."},
});

Json methods_json() {
  Json list = Json::array();
  for (const MethodText& method : kMethods) {
    list.push_back({{"name", method.name},
                    {"equation", method.equation},
                    {"good_for", method.good_for},
                    {"choose_when", method.choose_when}});
  }
  return list;
}

Json presets_json() {
  Json list = Json::array();
  for (const Preset preset : kPresets) {
    list.push_back({{"name", name_of(preset)},
                    {"description", description_of(preset)},
                    {"parameters", values_of(preset)}});
  }
  return list;
}

}  // namespace

std::span<const MethodText> method_texts() {
  return kMethods;
}

Json methods_document() {
  return {
      {"methods", methods_json()}, {"presets", presets_json()}, {"parameters", parameter_schema()}};
}

}  // namespace fairway
