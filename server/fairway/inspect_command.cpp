// `fairway inspect`: what a file holds and what a run would meet, as a table or as JSON.

#include <algorithm>

#include <fmt/format.h>

#include "server/fairway/commands.h"
#include "server/fairway/input_file.h"
#include "server/fairway/inspect.h"
#include "server/fairway/side_folder.h"
#include "server/os/memory.h"

namespace fairway {
namespace {

template <class... Values>
void row(const char* name, fmt::format_string<Values...> text, const Values&... values) {
  fmt::print("  {:<14}{}\n", name, fmt::vformat(text, fmt::make_format_args(values...)));
}

void print_topology(const HalfedgeTopology& topology, const SurfaceCounts& counts) {
  row("topology", "components {}, boundary loops {}, Euler characteristic {}", topology.components,
      topology.boundary_loops, topology.euler_characteristic);
  constexpr std::size_t kMost = 5;
  for (std::size_t i = 0; i < std::min(kMost, topology.pieces.size()); ++i) {
    const ComponentTopology& piece = topology.pieces[i];
    const auto genus = piece.genus();
    row(i == 0 ? "components" : "", "{} vertices, {} faces, {}", piece.vertices, piece.faces,
        genus ? fmt::format("closed, genus {}", *genus)
              : fmt::format("open, boundary loops {}", piece.boundary_loops));
  }
  for (std::size_t i = 0; i < std::min(kMost, topology.loops.size()); ++i) {
    row(i == 0 ? "loops" : "", "{} edges, {:.4g} long", topology.loops[i].edges,
        topology.loops[i].length);
  }
  row("building", "{} welded, {} split, {} isolated, {} degenerate, {} duplicate", counts.welded,
      counts.split, counts.isolated, counts.degenerate_triangles, counts.duplicate_triangles);
}

void print_measures(const SurfaceMeasures& measures) {
  const Vec3& low = measures.box_min;
  const Vec3& high = measures.box_max;
  row("box", "({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", low.x(), low.y(), low.z(),
      high.x(), high.y(), high.z());
  const Spread& edge = measures.edge_length;
  row("edge length", "mean {:.4g}, {:.4g} to {:.4g}", edge.mean, edge.least, edge.largest);
  const Spread& area = measures.triangle_area;
  row("triangle area", "mean {:.4g}, {:.4g} to {:.4g}, together {:.6g}", area.mean, area.least,
      area.largest, measures.area);
}

void print_surface(const SurfaceInspection& surface) {
  fmt::print("{}: {} vertices, {} triangles\n", surface.name, surface.source_vertices,
             surface.source_triangles);
  if (!surface.findings) return;
  const SurfaceFindings& found = *surface.findings;
  row("surface", "{} vertices, {} edges, {} faces", found.vertices, found.measures.edges,
      found.faces);
  print_topology(found.topology, found.counts);
  print_measures(found.measures);
  row("noise", "about {:.3f} mean edge lengths{}", found.noise.noise,
      found.noise.clean() ? ": clean, an automatic run changes nothing" : "");
}

void print_inspection(const Inspection& inspection) {
  fmt::print("{}, {} bytes, meshes {}, primitives {}\n", name_of(inspection.format),
             inspection.bytes, inspection.meshes, inspection.primitives);
  for (const SurfaceInspection& surface : inspection.surfaces) print_surface(surface);
  const CostEstimate cost = estimate_of(inspection);
  constexpr double kMegabyte = 1e6;
  fmt::print("a default run: {} steps, about {:.2g} s and {:.0f} MB\n", cost.steps, cost.seconds,
             static_cast<double>(cost.memory_bytes) / kMegabyte);
  for (const std::string& warning : all_warnings(inspection)) fmt::print("- {}\n", warning);
}

}  // namespace

Result<void> run(const InspectCommand& command) {
  const Result<InputFile> input = InputFile::open(command.input);
  if (!input) return input.error();
  const auto head = input->bytes().first(std::min(input->bytes().size(), kMagicBytes));
  const Result<Format> format = recognise_format(head, "", command.input);
  if (!format) return format.error();
  prepare_heap(heap_estimate(input->bytes().size()));
  SideFolder files(command.input);
  const Result<Inspection> found = inspect(input->bytes(), *format, {}, files.provider());
  if (!found) return found.error();
  if (command.json) {
    fmt::print("{}\n", dump_json(inspection_document(*found)));
  } else {
    print_inspection(*found);
  }
  return {};
}

}  // namespace fairway
