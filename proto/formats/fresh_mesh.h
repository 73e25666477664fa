#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/document.h"

namespace fairway {

/// The names of an attribute's components as properties of a PLY vertex: lower case without the
/// leading underscore ("_CURVATURE_K1": curvature_k1, "_FEATURE": feature), with _x, _y, _z behind
/// where there are three ("_CURVATURE_DIR1": curvature_dir1_x …).
std::vector<std::string> property_names(const VertexAttribute& attribute);

/// A new file around one surface: positions, triangles, normals if it has some, and where the
/// format has a place for them (glb, gltf, drc, ply) attributes. PLY is binary little-endian and
/// STL binary. Errors: for a position that no float holds diverged if it moved, else invalid_mesh,
/// unsupported_feature (values that Draco cannot store), too_large.
Result<Encoded> write_fresh_mesh(const Surface& surface, const SurfaceResult& result, Format format,
                                 const Encoding& encoding);

/// What a file came as and what it is written as.
struct Conversion {
  Format came;
  Format wanted;
  Encoding encoding = {};
};

/// `document` written as it is wanted: by itself where it can, else as a fresh mesh. Errors: those
/// of Document::write() and write_fresh_mesh(); unsupported_feature where several meshes would have
/// to become one.
Result<Encoded> convert(const Document& document, std::span<const SurfaceResult> results,
                        const Conversion& conversion);

/// The bytes of convert() with the default encoding.
Result<std::vector<std::byte>> convert(const Document& document,
                                       std::span<const SurfaceResult> results, Format came,
                                       Format wanted);

/// Sentences for the job's notes: what `document`, which came as `came`, loses as `wanted`, and
/// that new attributes have no place there.
std::vector<std::string> conversion_notes(const Document& document,
                                          std::span<const SurfaceResult> results, Format came,
                                          Format wanted);

/// Sentences about primitives that keep the colours they have although new ones were asked for.
std::vector<std::string> kept_color_notes(std::span<const Surface> surfaces,
                                          std::span<const SurfaceResult> results,
                                          const Conversion& conversion);

}  // namespace fairway
