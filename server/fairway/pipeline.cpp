// The pipeline that `fairway denoise` and `fairway worker` run.

#include "server/fairway/pipeline.h"

#include <algorithm>
#include <limits>
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

/// float32, finite: what lies beyond its range becomes its largest value.
float to_float(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

/// Values of surface vertices as those of source vertices; 0 where `vertex` has none.
VertexAttribute scalar_attribute(CurvatureKind kind, const std::vector<double>& values,
                                 std::span<const Index> vertex) {
  VertexAttribute out{std::string(attribute_name(kind)), 1, {}};
  out.values.reserve(vertex.size());
  for (const Index v : vertex) out.values.push_back(v == kNoIndex ? 0.0F : to_float(values[v]));
  return out;
}

VertexAttribute vector_attribute(CurvatureKind kind, const std::vector<Vec3>& values,
                                 std::span<const Index> vertex) {
  VertexAttribute out{std::string(attribute_name(kind)), 3, {}};
  out.values.reserve(3 * vertex.size());
  for (const Index v : vertex) {
    const Vec3 value = v == kNoIndex ? Vec3(Vec3::Zero()) : values[v];
    for (const double c : {value.x(), value.y(), value.z()}) out.values.push_back(to_float(c));
  }
  return out;
}

VertexAttribute attribute(CurvatureKind kind, const CurvatureFields& fields,
                          std::span<const Index> vertex) {
  switch (kind) {
    case CurvatureKind::k1:
      return scalar_attribute(kind, fields.k1, vertex);
    case CurvatureKind::k2:
      return scalar_attribute(kind, fields.k2, vertex);
    case CurvatureKind::mean:
      return scalar_attribute(kind, fields.mean, vertex);
    case CurvatureKind::gaussian:
      return scalar_attribute(kind, fields.gaussian, vertex);
    case CurvatureKind::predominant:
      return scalar_attribute(kind, fields.predominant, vertex);
    case CurvatureKind::dir1:
      return vector_attribute(kind, fields.dir1, vertex);
    case CurvatureKind::dir2:
      break;
  }
  return vector_attribute(kind, fields.dir2, vertex);
}

/// float32, so that every reader takes it: bytes would have to stand four apart.
VertexAttribute feature_attribute(std::span<const unsigned char> flags) {
  VertexAttribute out{std::string(kFeatureAttribute), 1, {}};
  out.values.reserve(flags.size());
  for (const unsigned char flag : flags) out.values.push_back(flag != 0 ? 1.0F : 0.0F);
  return out;
}

void add_attributes(const CurvatureFields& fields, std::span<const Index> vertex,
                    const Parameters& parameters, SurfaceResult& result) {
  for (const CurvatureKind kind : parameters.curvature) {
    result.attributes.push_back(attribute(kind, fields, vertex));
  }
}

SurfaceReport describe(const Surface& surface, const TriangleMesh& mesh, FlowReport flow) {
  const SurfaceTopology topology = surface_topology(mesh);
  return {surface.name,        mesh.counts(),           mesh.vertex_count(), mesh.faces().size(),
          topology.components, topology.boundary_loops, std::move(flow)};
}

/// One surface: topology → flow → curvature.
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
  if (!parameters.curvature.empty()) {
    add_attributes(curvature(mesh, denoised->positions), mesh.vertex_of_source(), parameters,
                   result);
  }
  if (parameters.flow.find_features) {
    result.attributes.push_back(feature_attribute(scatter_flags(mesh, denoised->features)));
  }
  report.surfaces.push_back(describe(surface, mesh, std::move(denoised->report)));
  return result;
}

/// A surface that has nothing to compute with stays as it is.
SurfaceResult leave_alone(const Surface& surface, const Parameters& parameters, const Error& why,
                          JobReport& report) {
  SurfaceResult result;
  const std::size_t vertices = surface.mesh.positions.size();
  add_attributes({}, std::vector<Index>(vertices, kNoIndex), parameters, result);
  if (parameters.flow.find_features) {
    result.attributes.push_back(feature_attribute(std::vector<unsigned char>(vertices)));
  }
  report.notes.push_back(fmt::format("{} was left as it is: {}", surface.name, why.message));
  return result;
}

Result<std::vector<SurfaceResult>> denoise_all(const Document& document, Parameters parameters,
                                               ProgressTeller& progress,
                                               const std::stop_token& stop, JobReport& report) {
  auto fixed = find_fixed_vertices(document.surfaces(), parameters.fixed_vertices);
  if (!fixed) return fixed.error();
  std::vector<SurfaceResult> results;
  std::optional<Error> first_unusable;
  for (std::size_t i = 0; i < document.surfaces().size(); ++i) {
    const Surface& surface = document.surfaces()[i];
    parameters.flow.fixed_vertices = std::move((*fixed)[i]);
    progress.next_surface(surface.mesh.triangles.size());
    progress.stage("topology", 0.0);
    const Result<TriangleMesh> mesh = TriangleMesh::build(surface.mesh);
    if (!mesh) {
      results.push_back(leave_alone(surface, parameters, mesh.error(), report));
      if (!first_unusable) first_unusable = mesh.error();
      continue;
    }
    Result<SurfaceResult> result =
        denoise_surface(surface, *mesh, parameters, progress, stop, report);
    if (!result) return result.error();
    results.push_back(*std::move(result));
  }
  if (report.surfaces.empty() && first_unusable) return *first_unusable;
  return results;
}

}  // namespace

Result<PipelineOutput> run_pipeline(std::span<const std::byte> input, Format format,
                                    const Parameters& parameters, const ProgressObserver& observer,
                                    const std::stop_token& stop, const SideFiles& side_files) {
  if (observer) observer({"decode", 0, 0, 0.0});
  Result<std::unique_ptr<Document>> document = decode(input, format, side_files);
  if (!document) return document.error();
  std::size_t triangles = 0;
  for (const Surface& s : (*document)->surfaces()) triangles += s.mesh.triangles.size();

  PipelineOutput out;
  out.format = parameters.output.value_or(format);
  out.report.notes = (*document)->notes();
  ProgressTeller progress(observer, triangles);
  const Result<std::vector<SurfaceResult>> results =
      denoise_all(**document, parameters, progress, stop, out.report);
  if (!results) return results.error();
  progress.stage("encode", 1.0);
  for (std::string& note : conversion_notes(**document, *results, format, out.format)) {
    out.report.notes.push_back(std::move(note));
  }
  Result<Encoded> encoded =
      convert(**document, *results, {format, out.format, parameters.encoding});
  if (!encoded) return encoded.error();
  out.bytes = std::move(encoded->bytes);
  for (std::string& note : encoded->notes) out.report.notes.push_back(std::move(note));
  return out;
}

}  // namespace fairway
