#pragma once

#include "server/fairway/commands.h"

namespace fairway {

/// Tries the sandbox of a worker in children of this process, one for each trial, and prints a line
/// for each: "ok" or "FAILED", what was tried, how it went. Lines that begin with "note" say what
/// the kernel refuses. Returns the exit code: 0 only where all is as it has to be.
int test_sandbox(SelfTest how);

}  // namespace fairway
