#pragma once

#include <span>
#include <string>
#include <vector>

#include "proto/messages/report.h"

namespace fairway {

/// Sentences about what a person should know of the surfaces and would not look for in the report:
/// what was split or left out of the computation, whose curvature stays local, which range the
/// colours have. At most one sentence a surface of each kind, and bounded for many surfaces.
std::vector<std::string> surface_notes(std::span<const SurfaceReport> surfaces);

}  // namespace fairway
