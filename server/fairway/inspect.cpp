// What `fairway inspect` and an inspecting worker run: the pipeline without a flow.

#include "server/fairway/inspect.h"

#include <memory>
#include <utility>

#include "core/denoise.h"
#include "core/halfedge.h"
#include "core/surface_measures.h"
#include "core/triangle_mesh.h"
#include "proto/formats/document.h"

namespace fairway {
namespace {

SurfaceInspection inspect_surface(const Surface& surface) {
  SurfaceInspection out;
  out.name = surface.name;
  out.source_vertices = surface.mesh.positions.size();
  out.source_triangles = surface.mesh.triangles.size();
  out.single_precision = surface.single_precision;
  const Result<TriangleMesh> mesh = TriangleMesh::build(surface.mesh);
  if (!mesh) {
    out.problem = mesh.error();
    return out;
  }
  out.findings =
      SurfaceFindings{mesh->counts(),           mesh->vertex_count(),    mesh->faces().size(),
                      halfedge_topology(*mesh), surface_measures(*mesh), find_noise(*mesh)};
  return out;
}

}  // namespace

Result<Inspection> inspect(std::span<const std::byte> input, Format format,
                           const ProgressObserver& observer, const SideFiles& side_files) {
  if (observer) observer({"decode", 0, 0, 0.0});
  const Result<std::unique_ptr<Document>> document = decode(input, format, side_files);
  if (!document) return document.error();
  const FileFacts& facts = (*document)->facts();
  Inspection out;
  out.format = format;
  out.bytes = input.size();
  out.meshes = facts.meshes;
  out.primitives = facts.primitives;
  out.notes = (*document)->notes();
  out.notes.insert(out.notes.end(), facts.untouched.begin(), facts.untouched.end());
  const std::vector<Surface>& surfaces = (*document)->surfaces();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (observer) {
      observer({"topology", 0, 0, static_cast<double>(i) / static_cast<double>(surfaces.size())});
    }
    out.surfaces.push_back(inspect_surface(surfaces[i]));
  }
  return out;
}

}  // namespace fairway
