// What an inspection found as sentences and as JSON.

#include "proto/messages/inspection.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proto/messages/problem.h"

namespace fairway {
namespace {

// A file may have any number of meshes, the document has to fit one line of the worker's.
constexpr std::size_t kMostSurfaces = 200;
constexpr std::size_t kMostWarnings = 300;
constexpr std::size_t kMostListed = 5;  // components, boundary loops

// Diagonals of the bounding box that hardly anybody means, in the file's units.
constexpr double kTiny = 1e-4;
constexpr double kHuge = 1e6;
/// A step of single precision, in mean edges, that is seen as noise.
constexpr double kCoarse = 0.001;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json vector(const Vec3& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json spread(const Spread& of) {
  return {{"min", of.least}, {"mean", number(of.mean)}, {"max", number(of.largest)}};
}

Json genus_of(const ComponentTopology& piece) {
  const std::optional<long> genus = piece.genus();
  return genus ? Json(*genus) : Json(nullptr);
}

Json genus_of(const HalfedgeTopology& topology) {
  std::optional<long> sum;
  for (const ComponentTopology& piece : topology.pieces) {
    if (const auto genus = piece.genus()) sum = sum.value_or(0) + *genus;
  }
  return sum ? Json(*sum) : Json(nullptr);
}

void add_topology(const HalfedgeTopology& topology, Json& out) {
  out["components"] = topology.components;
  out["boundary_loops"] = topology.boundary_loops;
  out["euler_characteristic"] = topology.euler_characteristic;
  out["genus"] = genus_of(topology);
  Json components = Json::array();
  for (std::size_t i = 0; i < std::min(kMostListed, topology.pieces.size()); ++i) {
    const ComponentTopology& piece = topology.pieces[i];
    components.push_back({{"vertices", piece.vertices},
                          {"faces", piece.faces},
                          {"boundary_loops", piece.boundary_loops},
                          {"euler_characteristic", piece.euler_characteristic},
                          {"genus", genus_of(piece)}});
  }
  out["largest_components"] = std::move(components);
  Json loops = Json::array();
  for (std::size_t i = 0; i < std::min(kMostListed, topology.loops.size()); ++i) {
    loops.push_back({{"edges", topology.loops[i].edges}, {"length", topology.loops[i].length}});
  }
  out["largest_boundary_loops"] = std::move(loops);
}

void add_findings(const SurfaceFindings& found, Json& out) {
  out["vertices"] = found.vertices;
  out["edges"] = found.measures.edges;
  out["faces"] = found.faces;
  out["welded"] = found.counts.welded;
  out["split"] = found.counts.split;
  out["isolated"] = found.counts.isolated;
  out["degenerate_triangles"] = found.counts.degenerate_triangles;
  out["duplicate_triangles"] = found.counts.duplicate_triangles;
  out["needle_triangles"] = found.measures.needles;
  out["boundary_edges"] = found.counts.boundary_edges;
  add_topology(found.topology, out);
  out["bounding_box"] = {{"min", vector(found.measures.box_min)},
                         {"max", vector(found.measures.box_max)}};
  out["edge_length"] = spread(found.measures.edge_length);
  out["triangle_area"] = spread(found.measures.triangle_area);
  out["area"] = number(found.measures.area);
  out["noise"] = number(found.noise.noise);
  out["clean"] = found.noise.clean();
}

Json surface_document(const SurfaceInspection& surface) {
  Json out = {{"name", surface.name},
              {"source_vertices", surface.source_vertices},
              {"source_triangles", surface.source_triangles}};
  if (surface.findings) {
    add_findings(*surface.findings, out);
  } else if (surface.problem) {
    out["problem"] = {{"code", problem_kind(surface.problem->code).slug},
                      {"detail", surface.problem->message}};
  }
  return out;
}

/// Sentences about one surface, each with its name.
class Warnings {
 public:
  explicit Warnings(const std::string& name) : name_(name) {}

  template <class... Values>
  void add(fmt::format_string<Values...> text, const Values&... values) {
    out_.push_back(name_ + ": " + fmt::vformat(text, fmt::make_format_args(values...)));
  }
  std::vector<std::string> take() { return std::move(out_); }

 private:
  const std::string& name_;
  std::vector<std::string> out_;
};

void warn_of_topology(const SurfaceFindings& found, Warnings& out) {
  const SurfaceCounts& counts = found.counts;
  if (counts.split > 0) {
    out.add(
        "it is not manifold; it was split at edges of more than two faces or of faces turned "
        "against each other (copies of vertices: {}), and seams there count as boundary. Repair "
        "it, or let \"boundary\": \"fixed\" hold the seams.",
        counts.split);
  }
  if (found.topology.boundary_loops > 0) {
    out.add(
        "it is open (boundary loops: {}, edges of them: {}). The boundary moves with the surface; "
        "\"boundary\": \"fixed\" keeps it in place.",
        found.topology.boundary_loops, counts.boundary_edges);
  }
  if (counts.degenerate_triangles + counts.duplicate_triangles > 0) {
    out.add(
        "degenerate triangles ({}) and duplicate ones ({}) are left out of the computation and "
        "stay in the file. Remove them where they are not meant.",
        counts.degenerate_triangles, counts.duplicate_triangles);
  }
}

void warn_of_size(const SurfaceInspection& surface, const SurfaceMeasures& measures,
                  Warnings& out) {
  const double diagonal = measures.box_diagonal();
  if (diagonal < kTiny || diagonal > kHuge) {
    out.add(
        "it is {} ({:.3g} units across). Results do not depend on the unit, but curvature is in "
        "1/length and many programs expect metres; scale the mesh.",
        diagonal < kTiny ? "tiny" : "huge", diagonal);
  }
  if (measures.needles > 0) {
    out.add(
        "it has needle triangles ({}), with a height below a hundredth of a side. Leave "
        "\"guards\".\"local_step\" on, or remesh them first.",
        measures.needles);
  }
  const double step = std::ldexp(measures.reach(), -23) / measures.edge_length.mean;
  if (surface.single_precision && step > kCoarse) {
    out.add(
        "it lies so far from the origin that single precision moves vertices in steps of {:.2g} "
        "mean edges. Export it nearer to the origin, or with double coordinates (PLY, OBJ).",
        step);
  }
}

}  // namespace

std::vector<std::string> surface_warnings(const SurfaceInspection& surface) {
  Warnings out(surface.name);
  if (surface.problem) {
    out.add("it cannot be computed with. {}", surface.problem->message);
  }
  if (surface.findings) {
    warn_of_topology(*surface.findings, out);
    warn_of_size(surface, surface.findings->measures, out);
  }
  return out.take();
}

CostEstimate estimate_of(const Inspection& inspection) {
  CostSubject subject;
  subject.format = inspection.format;
  subject.bytes = inspection.bytes;
  for (const SurfaceInspection& surface : inspection.surfaces) {
    subject.vertices += surface.source_vertices;
    subject.triangles += surface.source_triangles;
    if (!surface.findings) continue;
    const int steps = surface.findings->noise.most_steps;
    subject.vertex_steps += static_cast<double>(surface.findings->vertices) * steps;
    subject.steps = std::max(subject.steps, steps);
  }
  return estimate_cost(subject);
}

std::vector<std::string> all_warnings(const Inspection& inspection) {
  std::vector<std::string> out = inspection.notes;
  for (const SurfaceInspection& surface : inspection.surfaces) {
    for (std::string& warning : surface_warnings(surface)) out.push_back(std::move(warning));
  }
  return out;
}

Json inspection_document(const Inspection& inspection) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const SurfaceInspection& surface : inspection.surfaces) {
    vertices += surface.source_vertices;
    triangles += surface.source_triangles;
  }
  const std::size_t listed = std::min(inspection.surfaces.size(), kMostSurfaces);
  Json surfaces = Json::array();
  for (std::size_t i = 0; i < listed; ++i) {
    surfaces.push_back(surface_document(inspection.surfaces[i]));
  }
  std::vector<std::string> warnings = all_warnings(inspection);
  const std::size_t more = warnings.size() - std::min(warnings.size(), kMostWarnings);
  warnings.resize(warnings.size() - more);
  if (more > 0) warnings.push_back(fmt::format("{} more warnings are not shown.", more));
  if (listed < inspection.surfaces.size()) {
    warnings.push_back(
        fmt::format("{} of {} surfaces are listed.", listed, inspection.surfaces.size()));
  }
  const CostEstimate cost = estimate_of(inspection);
  return {{"format", name_of(inspection.format)},
          {"bytes", inspection.bytes},
          {"meshes", inspection.meshes},
          {"primitives", inspection.primitives},
          {"vertices", vertices},
          {"triangles", triangles},
          {"surfaces", std::move(surfaces)},
          {"estimate",
           {{"steps", cost.steps}, {"seconds", cost.seconds}, {"memory_bytes", cost.memory_bytes}}},
          {"warnings", std::move(warnings)}};
}

}  // namespace fairway
