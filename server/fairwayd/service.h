#pragma once

#include "core/result.h"
#include "server/fairwayd/settings.h"

namespace fairway {

/// Runs the service until SIGTERM or SIGINT. Prints one line on standard output when it is ready.
/// Errors: what kept it from starting.
Result<void> run_service(const Settings& settings);

}  // namespace fairway
