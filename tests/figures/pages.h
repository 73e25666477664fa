#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "tests/figures/figure.h"

namespace fairway {

/// The figure as HTML: a picture for each panel with its title and what was measured, the scale of
/// the colours, the caption. Pictures are expected at /docs/NAME-LETTER.png, the scale at
/// /docs/scale.png.
std::string html(const Figure& figure);

/// The text with what stands between "<!-- figure NAME -->" and "<!-- end -->" replaced; nothing
/// changes where there is no such place. Error malformed_input: a place without end.
Result<std::string> with_figure(std::string page, const std::string& name, const std::string& html);

/// Makes what the documentation shows, in its folder: the pictures of every figure that a page
/// there has a place for, and the figure in that place. Errors: io, those of the experiments.
Result<void> write_documentation(const std::filesystem::path& folder);

}  // namespace fairway
