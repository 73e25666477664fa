// Counts as sentences.

#include "proto/messages/surface_notes.h"

#include <algorithm>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Surfaces that are named for each kind of sentence.
constexpr std::size_t kMostNamed = 40;

std::string count(std::size_t number, std::string_view singular, std::string_view plural) {
  return fmt::format("{} {}", number, number == 1 ? singular : plural);
}

/// "" where nothing had to be done to the surface.
std::string describe_topology(const SurfaceReport& surface) {
  const SurfaceCounts& counts = surface.counts;
  std::vector<std::string> parts;
  if (counts.split > 0) {
    parts.push_back(count(counts.split, "vertex was", "vertices were") +
                    " split where the surface is not a manifold");
  }
  if (counts.degenerate_triangles > 0) {
    parts.push_back(count(counts.degenerate_triangles, "triangle", "triangles") +
                    " without three distinct corners left out of the computation");
  }
  if (counts.duplicate_triangles > 0) {
    parts.push_back(count(counts.duplicate_triangles, "triangle", "triangles") +
                    " on the corners of another left out of it");
  }
  if (counts.isolated > 0) {
    parts.push_back(count(counts.isolated, "vertex", "vertices") +
                    " that no such triangle uses left in place");
  }
  if (parts.empty()) return {};
  return fmt::format("{}: {} ({} welded, {}); the file keeps all of them", surface.name,
                     fmt::join(parts, ", "), count(counts.welded, "vertex", "vertices"),
                     count(surface.boundary_loops, "boundary loop", "boundary loops"));
}

std::string describe_space(const SurfaceReport& surface) {
  if (surface.why_local.empty()) return {};
  return fmt::format("{}: curvature stays in local lengths: {}", surface.name, surface.why_local);
}

template <class Describe>
void add(std::span<const SurfaceReport> surfaces, const Describe& describe, std::string_view more,
         std::vector<std::string>& out) {
  std::size_t told = 0;
  for (const SurfaceReport& surface : surfaces) {
    std::string sentence = describe(surface);
    if (!sentence.empty() && told++ < kMostNamed) out.push_back(std::move(sentence));
  }
  if (told > kMostNamed) out.push_back(fmt::format("{} more {}", told - kMostNamed, more));
}

/// One sentence for all surfaces; each one's limit is in the report.
void add_colors(std::span<const SurfaceReport> surfaces, std::vector<std::string>& out) {
  double least = 0.0;
  double most = 0.0;
  bool any = false;
  for (const SurfaceReport& surface : surfaces) {
    if (!surface.color_limit) continue;
    least = any ? std::min(least, *surface.color_limit) : *surface.color_limit;
    most = std::max(most, *surface.color_limit);
    any = true;
  }
  if (!any) return;
  out.push_back(
      least == most
          ? fmt::format("colours: predominant curvature from {:.4g} (blue) to {:.4g} (red)", -most,
                        most)
          : fmt::format("colours: predominant curvature from −limit (blue) to limit (red), a "
                        "color_limit for each mesh from {:.4g} to {:.4g}",
                        least, most));
}

}  // namespace

std::vector<std::string> surface_notes(std::span<const SurfaceReport> surfaces) {
  std::vector<std::string> out;
  add(surfaces, describe_topology, "meshes were split or left parts out: see the report", out);
  add(surfaces, describe_space, "meshes have curvature in local lengths", out);
  add_colors(surfaces, out);
  return out;
}

}  // namespace fairway
