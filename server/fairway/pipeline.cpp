// The pipeline that `fairway denoise` and `fairway worker` run.

#include "server/fairway/pipeline.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/features.h"
#include "core/normals.h"
#include "core/surface_topology.h"
#include "core/triangle_mesh.h"
#include "proto/formats/document.h"
#include "proto/formats/fixed_vertices.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/formats/selection.h"
#include "proto/formats/surface_weld.h"
#include "proto/messages/surface_notes.h"
#include "server/fairway/result_attributes.h"

namespace fairway {
namespace {

// Where the stages end on the scale of progress, as measured shares of a typical job.
constexpr double kDecoded = 0.04;
constexpr double kBuilt = 0.10;
constexpr double kFlowed = 0.90;
constexpr double kCurved = 0.94;

/// Tells where a job is; the fraction never falls.
class ProgressTeller {
 public:
  ProgressTeller(const ProgressObserver& observer, std::size_t triangles)
      : observer_(observer), triangles_(static_cast<double>(std::max<std::size_t>(triangles, 1))) {}

  /// The surface that is worked on now has this many of the triangles.
  void next_surface(std::size_t triangles) {
    done_ += share_;
    share_ = static_cast<double>(triangles) / triangles_;
  }

  void stage(const char* name, double end_of_stage) { tell({name, 0, 0, within(end_of_stage)}); }

  void step(const FlowStep& step) {
    const double part = static_cast<double>(step.step) / std::max(step.of, 1);
    tell({"flow", step.step, step.of, within(kBuilt + (kFlowed - kBuilt) * part)});
  }

 private:
  double within(double fraction_of_surface) const {
    return kDecoded + (kCurved - kDecoded) * (done_ + share_ * fraction_of_surface);
  }
  void tell(Progress progress) {
    last_ = progress.fraction = std::clamp(progress.fraction, last_, 1.0);
    if (observer_) observer_(progress);
  }

  const ProgressObserver& observer_;
  double triangles_;
  double done_ = 0.0;
  double share_ = 0.0;
  double last_ = 0.0;
};

SurfaceReport describe(const Surface& surface, const TriangleMesh& mesh, FlowReport flow) {
  const SurfaceTopology topology = surface_topology(mesh);
  return {surface.name,        mesh.counts(),           mesh.vertex_count(), mesh.faces().size(),
          topology.components, topology.boundary_loops, std::move(flow)};
}

/// The surface to compute with, its vertices welded as asked for.
Result<TriangleMesh> build_mesh(const Surface& surface, Welding welding) {
  if (welding == Welding::position) return TriangleMesh::build(surface.mesh);
  return TriangleMesh::build(surface.mesh, weld_elements(surface));
}

/// One surface: flow → curvature.
Result<SurfaceResult> denoise_surface(const Surface& surface, const TriangleMesh& mesh,
                                      const Parameters& parameters, ProgressTeller& progress,
                                      const std::stop_token& stop, JobReport& report) {
  progress.stage("flow", kBuilt);
  Result<Denoised> denoised = denoise(
      mesh, parameters.flow, [&progress](const FlowStep& step) { progress.step(step); }, stop);
  if (!denoised) return denoised.error();
  SurfaceResult result;
  result.moved = !denoised->report.steps.empty();
  if (result.moved) {
    result.positions = mesh.scatter_positions(surface.mesh, denoised->positions);
    if (!surface.normals.empty()) {
      result.normals = keep_split_normals(result.positions, surface.mesh.triangles,
                                          mesh.place_of_source(), surface.normals);
    }
  }
  progress.stage("curvature", kFlowed);
  report.surfaces.push_back(describe(surface, mesh, std::move(denoised->report)));
  if (!parameters.curvature.none()) {
    add_curvature(surface, curvature_floats(mesh, denoised->positions), mesh.vertex_of_source(),
                  parameters.curvature, result, report.surfaces.back());
  }
  if (parameters.flow.find_features) {
    result.attributes.push_back(feature_attribute(scatter_flags(mesh, denoised->features)));
  }
  return result;
}

/// A surface that has nothing to compute with stays as it is.
SurfaceResult leave_alone(const Surface& surface, const Parameters& parameters, const Error& why,
                          JobReport& report) {
  SurfaceResult result;
  const std::size_t vertices = surface.mesh.positions.size();
  add_zero_curvature(vertices, parameters.curvature, result);
  if (parameters.flow.find_features) {
    result.attributes.push_back(feature_attribute(std::vector<unsigned char>(vertices)));
  }
  report.notes.push_back(fmt::format("{} was left as it is: {}", surface.name, why.message));
  return result;
}

std::size_t count_triangles(std::span<const Surface> surfaces, const std::vector<bool>& selected) {
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (selected[i]) triangles += surfaces[i].mesh.triangles.size();
  }
  return triangles;
}

Result<std::vector<SurfaceResult>> denoise_all(const Document& document,
                                               const std::vector<bool>& selected,
                                               Parameters parameters, ProgressTeller& progress,
                                               const std::stop_token& stop, JobReport& report) {
  auto fixed = find_fixed_vertices(document.surfaces(), parameters.fixed_vertices);
  if (!fixed) return fixed.error();
  std::vector<SurfaceResult> results(document.surfaces().size());
  std::optional<Error> first_unusable;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Surface& surface = document.surfaces()[i];
    results[i].untouched = !selected[i];
    if (!selected[i]) continue;
    parameters.flow.fixed_vertices = std::move((*fixed)[i]);
    progress.next_surface(surface.mesh.triangles.size());
    progress.stage("topology", 0.0);
    const Result<TriangleMesh> mesh = build_mesh(surface, parameters.welding);
    if (!mesh) {
      results[i] = leave_alone(surface, parameters, mesh.error(), report);
      if (!first_unusable) first_unusable = mesh.error();
      continue;
    }
    Result<SurfaceResult> result =
        denoise_surface(surface, *mesh, parameters, progress, stop, report);
    if (!result) return result.error();
    results[i] = *std::move(result);
  }
  if (report.surfaces.empty() && first_unusable) return *first_unusable;
  return results;
}

/// What there is to tell once it is known what is written how.
void add_notes(const Document& document, std::span<const SurfaceResult> results,
               const Parameters& parameters, const Conversion& conversion, JobReport& report) {
  const auto add = [&report](std::vector<std::string> notes) {
    std::move(notes.begin(), notes.end(), std::back_inserter(report.notes));
  };
  add(surface_notes(report.surfaces));
  if (parameters.welding == Welding::none && conversion.came == Format::stl) {
    report.notes.emplace_back("STL has no indices: equal corners are one vertex all the same");
  }
  add(kept_color_notes(document, results, conversion));
  add(conversion_notes(document, results, conversion.came, conversion.wanted));
}

}  // namespace

Result<PipelineOutput> run_pipeline(std::span<const std::byte> input, Format format,
                                    const Parameters& parameters, const ProgressObserver& observer,
                                    const std::stop_token& stop, const SideFiles& side_files) {
  if (observer) observer({"decode", 0, 0, 0.0});
  Result<std::unique_ptr<Document>> decoded = decode(input, format, side_files);
  if (!decoded) return decoded.error();
  const std::shared_ptr<const Document> document = *std::move(decoded);
  const auto selected = select_surfaces(*document, parameters.selection);
  if (!selected) return selected.error();

  PipelineOutput out;
  out.format = parameters.output.value_or(format);
  out.report.notes = document->notes();
  const std::string left = describe_selection(document->surfaces(), *selected);
  if (!left.empty()) out.report.notes.push_back(left);
  ProgressTeller progress(observer, count_triangles(document->surfaces(), *selected));
  Result<std::vector<SurfaceResult>> denoised =
      denoise_all(*document, *selected, parameters, progress, stop, out.report);
  if (!denoised) return denoised.error();
  const auto results = std::make_shared<const std::vector<SurfaceResult>>(*std::move(denoised));
  progress.stage("encode", 1.0);
  const Conversion conversion{format, out.format, parameters.encoding};
  add_notes(*document, *results, parameters, conversion, out.report);
  Result<Encoded> encoded = convert(*document, *results, conversion);
  if (!encoded) return encoded.error();
  out.bytes = std::move(encoded->bytes);
  out.bytes.keep(document);
  out.bytes.keep(results);
  for (std::string& note : encoded->notes) out.report.notes.push_back(std::move(note));
  return out;
}

}  // namespace fairway
