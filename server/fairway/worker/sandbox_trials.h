#pragma once

#include <span>
#include <string_view>

namespace fairway {

/// Something that a process tries in the sandbox.
struct SandboxTrial {
  std::string_view name;
  /// Whether it succeeded; does not return where the sandbox ends the process.
  bool (*succeeds)();
};

/// What no worker may do: each must end by SIGSYS.
std::span<const SandboxTrial> forbidden_trials();

/// What workers do: each must succeed.
std::span<const SandboxTrial> allowed_trials();

}  // namespace fairway
