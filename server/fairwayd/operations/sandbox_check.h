#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "core/result.h"

namespace fairway {

/// What `fairway worker --self-test-sandbox` said.
struct SandboxCheck {
  bool passed = false;
  std::string failures;  ///< the lines of what failed, or how the program ended
  std::string note;      ///< what the kernel refuses, what the build leaves out
};

/// Runs the self-test and waits for its end, for a while. Errors: unavailable, io (it does not
/// start or does not end, or a stop was requested).
Result<SandboxCheck> run_self_test(const std::filesystem::path& worker,
                                   const std::stop_token& stop);

}  // namespace fairway
