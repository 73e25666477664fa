#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <linux/filter.h>

#include "core/result.h"

namespace fairway {

/// What a confined process may use; 0 = no limit. Whoever started it may lower them from outside.
struct SandboxLimits {
  std::uint64_t address_space = 0;  ///< bytes
  std::uint64_t cpu_seconds = 0;    ///< SIGXCPU at the end of them, SIGKILL a second later
  std::uint64_t file_bytes = 0;     ///< largest file it may write, bytes: SIGXFSZ beyond
};

/// The walls around a process that parses bytes from strangers, in two steps: prepare() when it
/// starts, close() once it has all descriptors that it needs and before it looks at the first of
/// those bytes.
class Sandbox {
 public:
  /// For the process that calls, for good: it ends with its parent (SIGKILL), has no capability,
  /// can gain no privilege, leaves no core, starts no process, keeps to the limits, and lives in a
  /// user and a network namespace of its own where the kernel allows. Before any thread is started.
  /// Errors: internal,
  /// memory_limit.
  static Result<Sandbox> prepare(const SandboxLimits& limits);

  /// No new descriptor, and the filter: from here on a system call that computing, memory and
  /// writing into open descriptors do not need ends the process with SIGSYS. Errors: internal,
  /// memory_limit.
  Result<void> close();

  /// Empty where the process has its own user and network namespace, else why not.
  const std::string& namespace_refusal() const { return namespace_refusal_; }

  /// False in builds with sanitizers, whose runtime needs files, processes and far more calls:
  /// there is neither filter nor limit of processes and descriptors.
  static bool has_filter();

 private:
  explicit Sandbox(std::string namespace_refusal)
      : namespace_refusal_(std::move(namespace_refusal)) {}

  std::string namespace_refusal_;
  std::vector<sock_filter> filter_;  ///< empty: none
};

}  // namespace fairway
