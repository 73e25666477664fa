#pragma once

#include <span>
#include <string>

#include "core/result.h"

namespace fairway {

/// fairwayd webhooks secret show|rotate [--tenant NAME] --data DIR (or the other ways to say a
/// setting): prints the tenant's signing secret; rotate makes a new one first. May run beside the
/// service. `arguments`: those after "webhooks". Errors: usage, not_found, as SqliteOutbox.
Result<void> run_webhooks_command(std::span<const char* const> arguments,
                                  std::span<const std::string> environment);

}  // namespace fairway
