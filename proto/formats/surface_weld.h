#pragma once

#include "core/weld.h"
#include "proto/formats/document.h"

namespace fairway {

/// Every vertex of the file by itself: the classes of a surface whose vertices are not welded by
/// position. What the surface has twice because primitives draw from one POSITION accessor with
/// different normals is one class, for it is one value in the file.
Weld weld_elements(const Surface& surface);

}  // namespace fairway
