#pragma once

#include <span>
#include <string>

#include "core/result.h"

namespace fairway {

/// `fairwayd webhooks secret show|rotate`: prints the tenant's signing secret; rotate makes a new
/// one first. Works on the data directory of the settings, beside a service that runs there.
/// `arguments`: those after the program's name; `environment`: "NAME=value". Returns what is to be
/// printed. Errors: usage, not_found, as SqliteOutbox.
Result<std::string> run_webhooks_command(std::span<const char* const> arguments,
                                         std::span<const std::string> environment);

}  // namespace fairway
