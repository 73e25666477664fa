#pragma once

#include "core/result.h"
#include "server/fairwayd/settings/settings.h"

namespace fairway {

/// Runs the service until SIGTERM or SIGINT; then running jobs may end within settings.drain, or
/// until a second signal, and what does not goes back to the queue. Prints a line for each listener
/// on standard output when it is ready.
/// Errors: what kept it from starting.
Result<void> run_service(const Settings& settings);

}  // namespace fairway
