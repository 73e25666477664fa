#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/denoise.h"
#include "core/triangle_mesh.h"
#include "proto/messages/json.h"

namespace fairway {

/// What happened to one surface of a document.
struct SurfaceReport {
  std::string name;
  SurfaceCounts counts;
  std::size_t vertices = 0;  ///< surface vertices, after welding and splitting
  std::size_t faces = 0;
  std::size_t components = 0;
  std::size_t boundary_loops = 0;
  FlowReport flow;
  std::optional<double> world_scale = {};  ///< that curvature was divided by, if it was asked for
  std::string why_local = {};              ///< why it was not, though it was asked for
  std::optional<double> color_limit = {};  ///< curvature of the last colours, if there are any
};

/// Everything a job has to tell.
struct JobReport {
  std::vector<SurfaceReport> surfaces;
  std::vector<std::string> notes;
};

/// The `report` of the job document: {"surfaces": […], "notes": […]}. Lengths in the mesh's local
/// units; volume and area changes are relative. Bounded, to fit in kMaxWorkerLine: of many surfaces
/// and notes the first are listed and a note counts them, of many steps an even choice.
Json report_document(const JobReport& report);

}  // namespace fairway
