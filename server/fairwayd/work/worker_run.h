#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.h"
#include "proto/messages/worker_protocol.h"
#include "server/fairwayd/work/worker_limits.h"
#include "server/fairwayd/work/worker_pool.h"
#include "server/os/child_process.h"
#include "server/os/event_flag.h"

namespace fairway {

/// One job for one process. The descriptors are regular files and stay the caller's.
struct WorkerTask {
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
  /// What to tell the client in the end: memory_limit; decoder_failed where it ended by itself
  /// before it told of any stage but "decode"; else worker_crashed.
  Error cause;
  std::string how;  ///< "signal 9", "exit code 3": for the log
};

/// keep_going said no.
struct WorkerStopped {};

/// How it went. `Finished`: the worker exited with 0 after saying so. `Failed`: it said why the job
/// cannot be done, or met its CPU limit or deadline (time_limit) or that of its result (too_large).
using WorkerEnd = std::variant<Finished, Failed, WorkerDied, WorkerStopped>;

/// Gives the task to a worker of the pool, follows it to its end, reaps it. A worker that died
/// before it had an order is no matter of the task: another one gets it. Errors: unavailable or io
/// where no process could be started: nothing was tried.
Result<WorkerEnd> run_worker(WorkerPool& pool, const WorkerTask& task, const WorkerWatch& watch);

}  // namespace fairway
