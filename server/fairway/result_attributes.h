#pragma once

#include <span>
#include <vector>

#include "core/curvature.h"
#include "core/index.h"
#include "proto/formats/document.h"
#include "proto/messages/curvature_output.h"
#include "proto/messages/report.h"

namespace fairway {

/// Adds to `result` what is asked of the curvature of a surface: attributes and colours, in the
/// lengths of the space that was asked for, and tells of it in `report`. `vertex`: for each vertex
/// of the file that of the fields, kNoIndex where it has none (its values are 0).
void add_curvature(const Surface& surface, CurvatureFloats fields, std::span<const Index> vertex,
                   const CurvatureOutput& output, SurfaceResult& result, SurfaceReport& report);

/// The same for a surface without any curvature: attributes of zeros, no colours.
void add_zero_curvature(std::size_t vertices, const CurvatureOutput& output, SurfaceResult& result);

/// _FEATURE from one flag per vertex of the file.
VertexAttribute feature_attribute(std::span<const unsigned char> flags);

}  // namespace fairway
