#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/document.h"

namespace fairway {

/// A new file around one surface: positions, triangles, normals if it has some, and where the
/// format has a place for them attributes (glb, gltf, drc, ply) and extras (these and obj). The
/// colours of `result` stand instead of those of `extras` where they shall replace them. PLY is
/// binary little-endian and STL binary. Errors: for a position that no float holds diverged if it
/// moved, else invalid_mesh, unsupported_feature (values that Draco cannot store), too_large.
Result<Encoded> write_fresh_mesh(const Surface& surface, const SurfaceResult& result, Format format,
                                 const Encoding& encoding, VertexExtras extras = {});

/// The only surface of `document` as a fresh mesh, with the extras that its file has. A note says
/// which of them cannot be read. Errors: those of write_fresh_mesh().
Result<Encoded> write_anew(const Document& document, const SurfaceResult& result, Format format,
                           const Encoding& encoding);

/// What a file came as and what it is written as.
struct Conversion {
  Format came;
  Format wanted;
  Encoding encoding = {};
};

/// `document` written as it is wanted: by itself where it can, else anew. Errors: those of
/// Document::write() and write_fresh_mesh(); unsupported_feature where several meshes would have
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
std::vector<std::string> kept_color_notes(const Document& document,
                                          std::span<const SurfaceResult> results,
                                          const Conversion& conversion);

}  // namespace fairway
