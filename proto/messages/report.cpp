// The job report as JSON.

#include "proto/messages/report.h"

#include <cmath>

namespace fairway {
namespace {

/// (after − before) / |before|, null where that says nothing.
Json relative_change(double before, double after) {
  if (before == 0.0 || !std::isfinite(after / before)) return nullptr;
  return (after - before) / std::abs(before);
}

/// The steps of a run as one entry each; long runs are thinned to at most 200, last one kept.
Json steps_document(const std::vector<FlowStep>& steps) {
  Json list = Json::array();
  const std::size_t stride = steps.size() / 200 + 1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i % stride != 0 && i + 1 != steps.size()) continue;
    const FlowStep& step = steps[i];
    Json entry = {{"step", step.step},
                  {"step_size", step.step_size},
                  {"feature_angle", step.feature_angle},
                  {"lambda", step.lambda},
                  {"displacement", step.displacement}};
    if (step.solver_iterations > 0) {
      entry["solver_iterations"] = step.solver_iterations;
      entry["solver_residual"] = step.solver_residual;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

Json flow_document(const FlowReport& flow) {
  return {{"mean_edge_length", flow.mean_edge_length},
          {"noise", flow.noise},
          {"step_size", flow.step_size},
          {"unfold_rounds", flow.unfold_rounds},
          {"steps_done", flow.steps.size()},
          {"feature_angle", flow.steps.empty() ? 0.0 : flow.steps.back().feature_angle},
          {"lambda", flow.steps.empty() ? 0.0 : flow.steps.back().lambda},
          {"rms_displacement", flow.rms_displacement},
          {"max_displacement", flow.max_displacement},
          {"volume_change", relative_change(flow.volume_before, flow.volume_after)},
          {"area_change", relative_change(flow.area_before, flow.area_after)},
          {"flipped_faces", flow.flipped_faces},
          {"steps", steps_document(flow.steps)},
          {"notes", flow.notes}};
}

Json surface_document(const SurfaceReport& surface) {
  const SurfaceCounts& counts = surface.counts;
  return {{"name", surface.name},
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
          {"flow", flow_document(surface.flow)}};
}

}  // namespace

Json report_document(const JobReport& report) {
  Json surfaces = Json::array();
  for (const SurfaceReport& surface : report.surfaces)
    surfaces.push_back(surface_document(surface));
  return {{"surfaces", std::move(surfaces)}, {"notes", report.notes}};
}

}  // namespace fairway
