#pragma once

#include "core/result.h"
#include "server/fairwayd/settings/settings.h"

namespace fairway {

/// `fairwayd --health`: asks the service that runs with these settings on this machine whether it
/// is ready (GET /readyz), within 5 s. For the health checks of containers, which have no other
/// program to ask with. Errors: usage (a port of 0 cannot be asked), unavailable (it does not
/// answer, or says what it lacks).
Result<void> check_health(const Settings& settings);

}  // namespace fairway
