// Untrusted bytes into a Document.

#include "proto/formats/document.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proto/formats/draco_document.h"
#include "proto/formats/gltf_document.h"
#include "proto/formats/shape_document.h"

namespace fairway {
namespace {

/// Smallest extent of a surface in steps of single precision at its distance from the origin.
constexpr double kLeastSteps = 16.0;

/// In files that hold single precision: far from the origin a small mesh collapses in it, and no
/// flow could write anything better back.
bool collapses_in_floats(const IndexedMesh& mesh) {
  constexpr std::size_t kFew = 256;
  Eigen::AlignedBox3d box;
  const auto steps = [&box] {
    const double farthest =
        std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    return box.diagonal().norm() / std::ldexp(farthest, -23);
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    box.extend(mesh.positions[i]);
    // Whatever else comes: twice as far from the origin, the box would be as large as half of that.
    if (i == kFew && steps() >= 2.0 * kLeastSteps) return false;
  }
  // A mesh that is one point has no triangles either, which is another answer.
  return !box.diagonal().isZero(0.0) && steps() < kLeastSteps;
}

Result<std::unique_ptr<Document>> decode_format(std::span<const std::byte> bytes, Format format,
                                                const SideFiles& side_files) {
  if (format == Format::drc) return decode_drc(bytes);
  if (format == Format::ply) return decode_ply(bytes);
  if (format == Format::obj) return decode_obj(bytes);
  if (format == Format::stl) return decode_stl(bytes);
  return decode_gltf(bytes, format, side_files);
}

}  // namespace

Encoded unchanged(ByteSpan bytes) {
  Encoded out;
  out.bytes.append_view(bytes);
  return out;
}

std::string counted(std::size_t count, std::string_view name) {
  if (count == 1) return fmt::format("1 {}", name);
  // The noun stands first: "primitives of points", "choices of a material".
  const std::size_t end = std::min(name.find(" of "), name.find(" as "));
  std::string noun(name.substr(0, end));
  if (noun.ends_with("property")) noun.replace(noun.size() - 1, 1, "ie");
  return fmt::format("{} {}s{}", count, noun, end < name.size() ? name.substr(end) : "");
}

Result<std::vector<std::byte>> Document::encode(std::span<const SurfaceResult> results,
                                                Format format) const {
  auto out = write(results, format, {});
  if (!out) return out.error();
  return out->bytes.joined();
}

Result<std::unique_ptr<Document>> decode(std::span<const std::byte> bytes, Format format,
                                         const SideFiles& side_files) {
  auto document = decode_format(bytes, format, side_files);
  if (!document) return document;
  const bool has_json = format == Format::glb || format == Format::gltf;
  for (const Surface& surface : (*document)->surfaces()) {
    if (surface.single_precision && collapses_in_floats(surface.mesh)) {
      return Error{ErrorCode::invalid_mesh,
                   "A mesh is so small and so far from the origin that single precision cannot "
                   "tell its vertices apart; move it to the origin first.",
                   has_json ? "/" + surface.name : ""};
    }
  }
  return document;
}

}  // namespace fairway
