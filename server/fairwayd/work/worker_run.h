#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.h"
#include "proto/messages/worker_protocol.h"
#include "server/os/child_process.h"
#include "server/os/event_flag.h"

namespace fairway {

/// Walls around one worker process.
struct WorkerLimits {
  std::uint64_t address_space = std::uint64_t{4} << 30;  ///< bytes; 0 = none
  std::chrono::seconds cpu{600};                         ///< of all its threads together
  std::chrono::seconds deadline{300};                    ///< wall clock, then SIGKILL
};

/// One job for one process. The descriptors are regular files and stay the caller's.
struct WorkerTask {
  std::filesystem::path program;
  int input = -1;
  int output = -1;
  WorkerOrder order;
  WorkerLimits limits;
};

/// What the caller hears and says while the worker runs; all called from the thread that runs it.
struct WorkerWatch {
  std::function<void(const Progress&)> on_progress;
  /// A line that is no event: what a library printed.
  std::function<void(std::string_view)> on_text;
  /// Asked at least once a second, and whenever `interrupt` is raised: false kills the worker.
  std::function<bool()> keep_going;
  const EventFlag& interrupt;
  /// The process was reaped.
  std::function<void(const ExitStatus&)> on_exit = [](const ExitStatus&) {};
};

/// The process died, or broke the protocol: not the job's statement about itself.
struct WorkerDied {
  Error cause;      ///< worker_crashed or memory_limit: what to tell the client in the end
  std::string how;  ///< "signal 9", "exit code 3": for the log
};

/// keep_going said no.
struct WorkerStopped {};

/// How it went. `Finished`: the worker exited with 0 after saying so. `Failed`: it said why the job
/// cannot be done, or met its CPU limit or deadline (time_limit).
using WorkerEnd = std::variant<Finished, Failed, WorkerDied, WorkerStopped>;

/// Starts a worker, follows it to its end, reaps it. Errors: unavailable or io where no process
/// could be started: nothing was tried.
Result<WorkerEnd> run_worker(const WorkerTask& task, const WorkerWatch& watch);

}  // namespace fairway
