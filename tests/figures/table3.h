#pragma once

#include <string>

#include "core/result.h"

namespace fairway {

/// Table 3 of the paper beside the same measured here, as Markdown: seconds for 10 steps of the
/// explicit and semi-implicit flows on one thread, the head in place of the Venus.
Result<std::string> table3();

}  // namespace fairway
