// The job report as JSON.

#include "proto/messages/report.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace fairway {
namespace {

// A file may have any number of meshes, the report has to fit one line of the worker's.
constexpr std::size_t kMostSurfaces = 300;
constexpr std::size_t kMostNotes = 500;
constexpr std::size_t kMostSteps = 1000;  // of all surfaces
constexpr std::size_t kMostStepsOfSurface = 200;

std::string_view name_of(FoundNoise noise) {
  switch (noise) {
    case FoundNoise::none:
      return "none";
    case FoundNoise::correlated:
      return "correlated";
    case FoundNoise::white:
      break;
  }
  return "white";
}

/// (after − before) / |before|, null where that says nothing.
Json relative_change(double before, double after) {
  if (before == 0.0 || !std::isfinite(after / before)) return nullptr;
  return (after - before) / std::abs(before);
}

Json step_document(const FlowStep& step) {
  Json entry = {{"step", step.step},
                {"feature_angle", step.feature_angle},
                {"lambda", step.lambda},
                {"displacement", step.displacement}};
  if (step.mu > 0.0) {
    entry["mu"] = step.mu;
    entry["degrees_of_freedom"] = step.degrees_of_freedom;
    entry["cross_validation"] = step.cross_validation;
    entry["solver_iterations"] = step.solver_iterations;
    return entry;
  }
  entry["step_size"] = step.step_size;
  if (step.solver_iterations > 0) {
    entry["solver_iterations"] = step.solver_iterations;
    entry["solver_residual"] = step.solver_residual;
  }
  return entry;
}

/// The steps of a run as one entry each; longer runs than `most` are thinned evenly, last one kept.
Json steps_document(const std::vector<FlowStep>& steps, std::size_t most) {
  Json list = Json::array();
  const std::size_t stride = steps.size() / most + 1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i % stride != 0 && i + 1 != steps.size()) continue;
    list.push_back(step_document(steps[i]));
  }
  return list;
}

Json flow_document(const FlowReport& flow, std::size_t most_steps) {
  Json out = {{"mean_edge_length", flow.mean_edge_length},
              {"noise", flow.noise},
              {"step_size", flow.step_size},
              {"unfold_rounds", flow.unfold_rounds},
              {"steps_done", flow.steps.size()},
              {"halved_steps", flow.halved_steps},
              {"feature_angle", flow.feature_angle},
              {"lambda", flow.lambda},
              {"rms_displacement", flow.rms_displacement},
              {"max_displacement", flow.max_displacement},
              {"volume_change", relative_change(flow.volume_before, flow.volume_after)},
              {"area_change", relative_change(flow.area_before, flow.area_after)},
              {"flipped_faces", flow.flipped_faces},
              {"steps", steps_document(flow.steps, most_steps)},
              {"notes", flow.notes}};
  if (flow.method == Method::variational) {
    out["noise_kind"] = name_of(flow.noise_kind);
    out["chosen_step"] = flow.chosen_step;
    out["strength"] = flow.strength;
    out["pass_band"] = flow.pass_band;
  }
  return out;
}

Json surface_document(const SurfaceReport& surface, std::size_t most_steps) {
  const SurfaceCounts& counts = surface.counts;
  Json out = {{"name", surface.name},
              {"source_vertices", counts.source_vertices},
              {"source_triangles", counts.source_triangles},
              {"vertices", surface.vertices},
              {"faces", surface.faces},
              {"components", surface.components},
              {"boundary_loops", surface.boundary_loops},
              {"welded", counts.welded},
              {"isolated", counts.isolated},
              {"split", counts.split},
              {"degenerate_triangles", counts.degenerate_triangles},
              {"duplicate_triangles", counts.duplicate_triangles},
              {"flow", flow_document(surface.flow, most_steps)}};
  if (surface.world_scale) out["world_scale"] = *surface.world_scale;
  if (surface.color_limit) out["color_limit"] = *surface.color_limit;
  return out;
}

}  // namespace

Json report_document(const JobReport& report) {
  const std::size_t listed = std::min(report.surfaces.size(), kMostSurfaces);
  const std::size_t most_steps =
      std::min(kMostStepsOfSurface, kMostSteps / std::max<std::size_t>(listed, 1));
  Json surfaces = Json::array();
  for (std::size_t i = 0; i < listed; ++i) {
    surfaces.push_back(surface_document(report.surfaces[i], most_steps));
  }
  const std::size_t told = std::min(report.notes.size(), kMostNotes);
  Json notes = Json::array();
  for (std::size_t i = 0; i < told; ++i) notes.push_back(report.notes[i]);
  if (told < report.notes.size()) {
    notes.push_back(fmt::format("{} more notes are not shown.", report.notes.size() - told));
  }
  if (listed < report.surfaces.size()) {
    notes.push_back(fmt::format("{} of {} surfaces are reported.", listed, report.surfaces.size()));
  }
  return {{"surfaces", std::move(surfaces)}, {"notes", std::move(notes)}};
}

}  // namespace fairway
