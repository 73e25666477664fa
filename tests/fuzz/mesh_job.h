#pragma once

#include <string>

#include "proto/formats/document.h"

namespace fairway::test {

/// What a job does with a mesh file, without the flow: decode, build the surfaces, move them a
/// little, compute curvature, encode, and read back what was written. Answers "", or which promise
/// was broken:
/// - a refusal has a documented code, a sentence and a pointer that is one;
/// - an accepted mesh has indices, positions, normals and primitives that fit each other;
/// - written back unmoved, positions and triangles are the same bit for bit;
/// - written back moved, in its own and another format, it reads again with the same counts, and
///   positions as near as the format can hold them, and has colours and texture coordinates where
///   the file had them and the format has a place.
std::string mesh_job_defect(std::span<const std::byte> bytes, Format format,
                            const SideFiles& side_files = {});

/// "" for an error that decode() may answer with, else what is wrong with it.
std::string refusal_defect(const Error& error);

}  // namespace fairway::test
