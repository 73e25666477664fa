#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/document.h"
#include "proto/messages/part_selection.h"

namespace fairway {

/// Whether each surface of a document is denoised: all of them, or those that a client named. In a
/// file without a scene, the only mesh is mesh 0. Error: invalid_parameters with the pointer of the
/// entry, for what the file does not have: meshes with triangles, and nodes with such a mesh.
Result<std::vector<bool>> select_surfaces(const Document& document, const MeshSelection& selection);

/// A sentence for the job's notes that says which are left as they are; "" if none is.
std::string describe_selection(std::span<const Surface> surfaces,
                               const std::vector<bool>& selected);

}  // namespace fairway
