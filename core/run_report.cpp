// What the report of every run has, whatever the method.

#include "core/run_report.h"

#include <algorithm>
#include <cmath>

#include "core/features.h"
#include "core/surface_geometry.h"

namespace fairway {

std::vector<unsigned char> held_vertices(const TriangleMesh& mesh, const FlowOptions& options) {
  std::vector<unsigned char> held = gather_flags(mesh, options.fixed_vertices);
  if (options.boundary == Boundary::free) return held;
  for (std::size_t v = 0; v < held.size(); ++v) held[v] |= mesh.boundary_vertex()[v];
  return held;
}

void compare_surfaces(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
                      FlowReport& report) {
  const SurfaceChange change =
      surface_change(mesh, mesh.positions(), positions, smallest_area(mean_edge));
  report.volume_before = change.volume_before;
  report.volume_after = change.volume_after;
  report.area_before = change.area_before;
  report.area_after = change.area_after;
  report.flipped_faces = change.flipped_faces;
  double sum = 0.0;
  double most = 0.0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const double d = (positions[v] - mesh.positions()[v]).norm() / mean_edge;
    sum += d * d;
    most = std::max(most, d);
  }
  report.rms_displacement = std::sqrt(sum / static_cast<double>(positions.size()));
  report.max_displacement = most;
}

}  // namespace fairway
