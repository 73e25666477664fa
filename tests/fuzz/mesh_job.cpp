// A mesh file's whole way through a job.

#include "tests/fuzz/mesh_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/curvature.h"
#include "core/normals.h"
#include "core/triangle_mesh.h"
#include "proto/formats/bytes.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/messages/problem.h"
#include "tests/fuzz/surface_check.h"

namespace fairway::test {
namespace {

/// Larger meshes are only decoded: a fuzzer lives from the number of its runs.
constexpr std::size_t kMostVertices = 2000;
constexpr std::size_t kMostTriangles = 4000;
/// How far the vertices move, in extents.
constexpr double kMovement = 1e-3;

bool is_small(const Document& document) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const Surface& surface : document.surfaces()) {
    vertices += surface.mesh.positions.size();
    triangles += surface.mesh.triangles.size();
  }
  return vertices <= kMostVertices && triangles <= kMostTriangles;
}

VertexAttribute attribute_of(std::string name, const std::vector<double>& values) {
  constexpr double kMost = std::numeric_limits<float>::max();
  VertexAttribute out{std::move(name), 1, {}};
  for (const double v : values)
    out.values.push_back(static_cast<float>(std::clamp(v, -kMost, kMost)));
  return out;
}

VertexAttribute attribute_of(std::string name, const std::vector<Vec3>& values) {
  VertexAttribute out{std::move(name), 3, {}};
  for (const Vec3& v : values) {
    for (int c = 0; c < 3; ++c) out.values.push_back(static_cast<float>(v[c]));
  }
  return out;
}

/// The surface's vertices moved by some thousandths of its extent, each in another direction.
std::vector<Vec3> displaced(const TriangleMesh& mesh, double extent) {
  std::vector<Vec3> out = mesh.positions();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto phase = static_cast<double>(i % 97);
    out[i] += kMovement * extent * Vec3(std::sin(phase), std::cos(3 * phase), std::sin(5 * phase));
  }
  return out;
}

/// As the pipeline does it; what cannot be computed with stays as it is and gets zeros.
SurfaceResult compute(const Surface& surface) {
  const std::size_t vertices = surface.mesh.positions.size();
  SurfaceResult result;
  const auto mesh = TriangleMesh::build(surface.mesh);
  if (!mesh) {
    result.attributes = {
        attribute_of("_CURVATURE_K1", std::vector<double>(vertices, 0.0)),
        attribute_of("_CURVATURE_DIR1", std::vector<Vec3>(vertices, Vec3::Zero()))};
    return result;
  }
  const std::vector<Vec3> moved = displaced(*mesh, extent_of(surface.mesh.positions));
  result.moved = true;
  IndexedMesh source{mesh->scatter_positions(surface.mesh, moved), surface.mesh.triangles};
  if (!surface.normals.empty()) {
    result.normals = keep_split_normals(source.positions, source.triangles, mesh->place_of_source(),
                                        surface.normals);
  }
  result.positions = std::move(source.positions);
  const CurvatureFields fields = scatter(*mesh, curvature(*mesh, moved));
  result.attributes = {attribute_of("_CURVATURE_K1", fields.k1),
                       attribute_of("_CURVATURE_DIR1", fields.dir1)};
  return result;
}

/// An error that writing may answer with.
std::string writing_defect(const Error& error) {
  switch (error.code) {
    case ErrorCode::unsupported_feature:
    case ErrorCode::too_large:
    case ErrorCode::diverged:
    case ErrorCode::invalid_mesh:
      return {};
    default:
      return fmt::format("writing fails with {}: {}", problem_kind(error.code).slug, error.message);
  }
}

/// Any of the formats and encodings, by what the bytes are, so that each input always takes the
/// same way.
Conversion other_conversion(ByteSpan bytes, Format came) {
  constexpr std::array<Format, 6> kFormats = {Format::glb, Format::gltf, Format::ply,
                                              Format::obj, Format::stl,  Format::drc};
  constexpr std::array<Compression, 4> kCompressions = {Compression::none, Compression::draco,
                                                        Compression::meshopt, Compression::keep};
  constexpr std::array<int, 4> kBits = {0, 2, 14, 30};
  std::uint64_t sum = 0xCBF29CE484222325U;
  for (const std::byte b : bytes) sum = (sum ^ std::to_integer<std::uint64_t>(b)) * 0x100000001B3U;
  sum >>= 24U;
  const auto one_of = [&sum](const auto& values) {
    const auto chosen = values[sum % values.size()];
    sum /= values.size();
    return chosen;
  };
  Conversion out{came, one_of(kFormats)};
  out.encoding.compression = one_of(kCompressions);
  DracoOptions& draco = out.encoding.draco;
  for (int* bits :
       {&draco.position_bits, &draco.normal_bits, &draco.texcoord_bits, &draco.curvature_bits}) {
    *bits = one_of(kBits);
  }
  draco.level = one_of(std::array<int, 4>{0, 3, 7, 10});
  draco.keep_order = one_of(std::array<bool, 2>{true, false});
  return out;
}

/// What nothing was done to comes back as it was.
std::string unmoved_defect(const Document& document, ByteSpan bytes, Format format) {
  const std::vector<SurfaceResult> results(document.surfaces().size());
  const auto written = document.encode(results, format);
  if (!written) {
    return format == Format::drc
               ? writing_defect(written.error())
               : "an accepted file cannot be written back: " + written.error().message;
  }
  const bool is_gltf = format == Format::glb || format == Format::gltf;
  if (!is_gltf && format != Format::drc) {
    const bool same = std::equal(written->begin(), written->end(), bytes.begin(), bytes.end());
    return same ? "" : "an unmoved file is not the same bytes";
  }
  const auto again = decode(*written, format);
  if (!again) return "what was written unmoved does not read: " + again.error().message;
  return same_surfaces_defect(document.surfaces(), (*again)->surfaces(),
                              format == Format::drc ? Likeness::counts : Likeness::bits);
}

/// Whether a mesh comes from Draco, or may be compressed with it again.
bool has_draco(const Document& document) {
  for (const Surface& surface : document.surfaces()) {
    for (const PrimitiveVertices& primitive : surface.primitives) {
      if (primitive.draco_view) return true;
    }
  }
  return false;
}

/// How much of the surfaces must come back.
Likeness likeness_of(const Document& document, const Conversion& conversion) {
  const auto& [came, wanted, encoding] = conversion;
  if (wanted == Format::stl) return Likeness::corners;
  if (wanted == Format::ply || wanted == Format::obj) return Likeness::floats;
  const bool lossy = wanted == Format::drc || has_draco(document) || came == Format::drc ||
                     encoding.compression == Compression::draco;
  return lossy ? Likeness::counts : Likeness::floats;
}

std::string moved_defect(const Document& document, std::span<const SurfaceResult> results,
                         const Conversion& conversion) {
  const Format wanted = conversion.wanted;
  const auto out = convert(document, results, conversion);
  if (!out) return writing_defect(out.error());
  for (const Surface& surface : document.surfaces()) {
    // Single precision cannot hold it, so the reader may find that it collapsed, or not.
    if (nearly_collapses(surface.mesh)) return {};
  }
  const Likeness likeness = likeness_of(document, conversion);
  const bool reordered = likeness == Likeness::counts && !conversion.encoding.draco.keep_order;
  const std::vector<std::byte> file = out->bytes.joined();
  const auto again = decode(file, wanted);
  if (!again) {
    // The few vertices that are used may all be rounded to one place.
    if (reordered && again.error().code == ErrorCode::invalid_mesh) return {};
    return fmt::format("what was written as {} does not read: {} {}", name_of(wanted),
                       again.error().pointer, again.error().message);
  }
  for (const std::string& defect :
       {extras_defect(**again), lost_extras_defect(document, **again, conversion)}) {
    if (!defect.empty()) return fmt::format("as {}: {}", name_of(wanted), defect);
  }
  // Where the order is free Draco leaves out what no triangle needs.
  if (reordered) return {};
  const std::string defect = same_surfaces_defect(with_results(document.surfaces(), results),
                                                  (*again)->surfaces(), likeness);
  return defect.empty() ? defect : fmt::format("as {}: {}", name_of(wanted), defect);
}

}  // namespace

std::string refusal_defect(const Error& error) {
  constexpr std::array<ErrorCode, 7> kMay = {ErrorCode::malformed_input,
                                             ErrorCode::unsupported_format,
                                             ErrorCode::unsupported_feature,
                                             ErrorCode::invalid_mesh,
                                             ErrorCode::no_triangles,
                                             ErrorCode::too_large,
                                             ErrorCode::io};
  if (std::find(kMay.begin(), kMay.end(), error.code) == kMay.end()) {
    return fmt::format("refused with {}: {}", problem_kind(error.code).slug, error.message);
  }
  if (error.message.size() < 10) return "refused without a sentence: " + error.message;
  if (!error.pointer.empty() && error.pointer.front() != '/') {
    return "refused with a pointer that is none: " + error.pointer;
  }
  return {};
}

std::string mesh_job_defect(ByteSpan bytes, Format format, const SideFiles& side_files) {
  const auto document = decode(bytes, format, side_files);
  if (!document) return refusal_defect(document.error());
  for (const Surface& surface : (*document)->surfaces()) {
    if (auto defect = surface_defect(surface); !defect.empty()) return defect;
  }
  if ((*document)->surfaces().empty()) return "accepted without a surface";
  if (!is_small(**document)) return {};
  if (auto defect = extras_defect(**document); !defect.empty()) return defect;
  if (auto defect = unmoved_defect(**document, bytes, format); !defect.empty()) return defect;
  std::vector<SurfaceResult> results;
  for (const Surface& surface : (*document)->surfaces()) results.push_back(compute(surface));
  const Format own = format == Format::drc ? Format::glb : format;
  if (auto defect = moved_defect(**document, results, {format, own}); !defect.empty()) {
    return defect;
  }
  return moved_defect(**document, results, other_conversion(bytes, format));
}

}  // namespace fairway::test
