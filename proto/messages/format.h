#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "core/result.h"

namespace fairway {

/// The mesh formats fairway speaks.
enum class Format { glb, gltf, drc, ply, obj, stl };

/// "glb", "gltf", "drc", "ply", "obj", "stl".
std::string_view name_of(Format format);
std::optional<Format> format_of_name(std::string_view name);

/// "model/gltf-binary", "model/gltf+json", "application/octet-stream" (Draco has no registered
/// type), "model/ply" (not registered either), "model/obj", "model/stl".
std::string_view media_type_of(Format format);

/// The format that a file name's extension names (any case), if it is one of ours.
std::optional<Format> format_of_file_name(std::string_view file_name);

/// How many leading bytes recognise_format() looks at.
inline constexpr std::size_t kMagicBytes = 512;

/// What the first bytes of an upload are: GLB, Draco and PLY by magic, glTF by a leading '{' (after
/// white space and a byte order mark), STL by "solid" or by a header, a count and a first triangle
/// that make sense, OBJ by the keyword of its first line that is no comment. OBJ and binary STL
/// have no magic: where the declared type or the name says so, their bytes are only asked not to be
/// another format. `declared_type` is the Content-Type (parameters ignored; empty,
/// application/octet-stream: recognise by the bytes and by `file_name`'s extension; so are other
/// types that programs give a file whose extension they do not know, where we know it). Errors:
/// malformed_input (nothing there), unsupported_format (a declared type that fairway does not take,
/// or that the magic contradicts; a GLB or Draco version fairway does not read; unknown bytes).
Result<Format> recognise_format(std::span<const std::byte> head, std::string_view declared_type,
                                std::string_view file_name);

}  // namespace fairway
