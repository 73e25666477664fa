#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/denoise.h"
#include "core/halfedge.h"
#include "core/surface_measures.h"
#include "core/triangle_mesh.h"
#include "proto/messages/cost_estimate.h"
#include "proto/messages/format.h"
#include "proto/messages/json.h"

namespace fairway {

/// What can be said of a surface that can be computed with.
struct SurfaceFindings {
  SurfaceCounts counts;
  std::size_t vertices = 0;  ///< after welding and splitting
  std::size_t faces = 0;
  HalfedgeTopology topology;
  SurfaceMeasures measures;
  NoiseFinding noise;
};

/// One surface of an inspected file: findings, or why there are none.
struct SurfaceInspection {
  std::string name;
  std::size_t source_vertices = 0;  ///< as the file has them
  std::size_t source_triangles = 0;
  bool single_precision = true;  ///< the file holds positions as floats
  std::optional<SurfaceFindings> findings;
  std::optional<Error> problem;  ///< exactly where there are no findings
};

/// What inspecting a file found. Nothing of it was changed, no flow was run.
struct Inspection {
  Format format = Format::glb;
  std::uint64_t bytes = 0;     ///< of the file itself, without those beside it
  std::size_t meshes = 0;      ///< of the file; 1 where it has no scene
  std::size_t primitives = 0;  ///< the same
  std::vector<SurfaceInspection> surfaces;
  std::vector<std::string> notes;  ///< about the file: what a run leaves untouched
};

/// One sentence, with the remedy, for each thing of a surface that a caller should know before a
/// run: topology (open, not manifold, degenerate and duplicate triangles), scale, needles, too few
/// digits. Empty for a clean closed surface.
std::vector<std::string> surface_warnings(const SurfaceInspection& surface);

/// The notes, then the warnings of every surface.
std::vector<std::string> all_warnings(const Inspection& inspection);

/// The whole file's estimate: surfaces without findings cost their decoding only.
CostEstimate estimate_of(const Inspection& inspection);

/// The document of POST /v1/inspect and `fairway inspect --json`:
/// - `format`, `bytes`, `meshes`, `primitives`, `vertices`, `triangles`: of the file;
/// - `surfaces`: one per mesh with triangles:
///   - `name`, `source_vertices`, `source_triangles`; `problem` {code, detail} in place of all that
///     follows where it cannot be computed with;
///   - `vertices`, `edges`, `faces`: after welding and splitting; `welded`, `split`, `isolated`,
///     `degenerate_triangles`, `duplicate_triangles`, `needle_triangles`: counts;
///   - `components`, `boundary_loops`, `boundary_edges`, `euler_characteristic` (V − E + F),
///     `genus` (sum over the closed components, null where none is closed);
///   - `largest_components` (by faces, at most 5): `vertices`, `faces`, `boundary_loops`,
///     `euler_characteristic`, `genus` (null where open);
///   - `largest_boundary_loops` (by length, at most 5): `edges`, `length`;
///   - `bounding_box` {`min`, `max`}, `edge_length` and `triangle_area` {`min`, `mean`, `max`},
///     `area`: in the mesh's own units, squared for areas;
///   - `noise`: the estimated σ of the positions, in mean edge lengths; `clean`: an automatic run
///     would leave the surface as it is;
/// - `estimate` of a run with default parameters: `steps`, `seconds` of one processor,
///   `memory_bytes` (estimate_cost());
/// - `warnings`: sentences, those of a surface begin with its name.
/// Bounded, to fit in kMaxWorkerLine: the first 200 surfaces and 300 warnings, and a warning counts
/// the others.
Json inspection_document(const Inspection& inspection);

}  // namespace fairway
