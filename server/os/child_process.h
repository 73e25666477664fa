#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// How a process ended.
struct ExitStatus {
  int code = 0;                                 ///< exit code, if `signal` is 0
  int signal = 0;                               ///< the signal that ended it, or 0
  std::chrono::milliseconds processor_time{0};  ///< user and system, of all its threads
  /// Most memory it had resident; at least what its parent had when it was spawned (wait4).
  std::uint64_t peak_resident_bytes = 0;
};

/// What to start: `descriptors` become 0, 1 and 2, and are all that the program gets.
struct SpawnRequest {
  std::filesystem::path program;
  std::vector<std::string> arguments;    ///< without the program's own name
  std::vector<std::string> environment;  ///< "NAME=value"; empty by default
  std::array<int, 3> descriptors{-1, -1, -1};
};

/// A running or ended child, in a process group of its own. Destroying it kills and reaps it, so
/// no child outlives its owner and none stays a zombie.
class ChildProcess {
 public:
  /// posix_spawn: no copy of the parent's memory map, whatever its size. Default signal handlers,
  /// no signal blocked. Errors: unavailable (no process or descriptor left), io (not executable).
  static Result<ChildProcess> spawn(const SpawnRequest& request);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  /// A pidfd: readable for poll() once the process has ended.
  int descriptor() const { return pidfd_.get(); }
  /// Sends a signal; nothing happens if the process has already been waited for.
  void kill(int signal) const;
  /// Blocks until the process ends, and reaps it. Later calls return the same status.
  ExitStatus wait();

 private:
  ChildProcess(pid_t pid, UniqueFd pidfd) : pid_(pid), pidfd_(std::move(pidfd)) {}

  pid_t pid_;
  UniqueFd pidfd_;
  bool reaped_ = false;
  ExitStatus status_;
};

/// A connected pair of stream sockets, close-on-exec. Errors: unavailable.
Result<std::pair<UniqueFd, UniqueFd>> socket_pair();

}  // namespace fairway
