#include "server/fairwayd/work/worker_run.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "proto/messages/problem.h"
#include "server/os/descriptor_passing.h"
#include "server/os/kill_point.h"
#include "server/os/line_reader.h"

namespace fairway {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kAskEvery{1000};
/// Between its last event and its exit a worker only has to leave; more is a hang.
constexpr milliseconds kLeaveWithin{5000};
/// The kernel accounts processor time to about this.
constexpr milliseconds kTick{50};

/// What a job may use of what its worker, which waited for any job, has allowed itself. It fails
/// only where the worker has already ended.
void limit_from_outside(pid_t pid, const WorkerLimits& limits) {
  const auto limit = [pid](__rlimit_resource resource, rlim_t soft, rlim_t hard) {
    const rlimit both{soft, hard};
    ::prlimit(pid, resource, &both, nullptr);
  };
  const std::uint64_t result =
      limits.result_bytes != 0 ? limits.result_bytes : limits.address_space;
  if (limits.address_space != 0) limit(RLIMIT_AS, limits.address_space, limits.address_space);
  if (result != 0) limit(RLIMIT_FSIZE, result, result);
  const auto seconds = static_cast<rlim_t>(limits.cpu.count());
  limit(RLIMIT_CPU, seconds, seconds + 1);
}

/// A worker of the pool that has the order and its files.
Result<WaitingWorker> engage(WorkerPool& pool, const WorkerTask& task) {
  const std::string order = format_line(task.order);
  while (true) {
    auto worker = pool.take();
    if (!worker) return worker.error();
    limit_from_outside(worker->process.pid(), task.limits);
    kill_point("worker.spawned");
    const auto sent =
        send_with_descriptors(worker->socket.get(), order, std::array{task.input, task.output});
    // Of one that was started for this task, its last words and its exit status tell more.
    if (sent || !worker->was_kept) return worker;
  }
}

constexpr std::string_view kDecodeStage = "decode";

Error time_limit(std::string_view what) {
  return {ErrorCode::time_limit,
          fmt::format("The job reached its {}: send a smaller mesh or ask for fewer steps.", what)};
}

/// One worker's conversation, from the order to the exit status.
class Conversation {
 public:
  Conversation(const WorkerTask& task, const WorkerWatch& watch, ChildProcess& process, int socket)
      : watch_(watch),
        process_(process),
        socket_(socket),
        lines_(socket, kMaxWorkerLine),
        cpu_limit_(task.limits.cpu),
        deadline_(Clock::now() + task.limits.deadline) {}

  WorkerEnd follow();

 private:
  void wait_for_something() const;
  void read_lines();
  void hear(const std::string& line);
  std::optional<WorkerEnd> reason_to_stop();
  WorkerEnd end_of(ExitStatus status);
  WorkerEnd end_of_signal(const ExitStatus& status) const;

  const WorkerWatch& watch_;
  ChildProcess& process_;
  int socket_;
  LineReader lines_;
  milliseconds cpu_limit_;
  Clock::time_point deadline_;
  bool socket_open_ = true;
  bool broke_protocol_ = false;
  bool decoded_ = false;             ///< a later stage was told of
  std::optional<WorkerEvent> last_;  ///< Finished or Failed, once heard
};

WorkerEnd Conversation::follow() {
  while (true) {
    wait_for_something();
    if (socket_open_) read_lines();
    if (auto stop = reason_to_stop()) {
      process_.kill(SIGKILL);
      watch_.on_exit(process_.wait());
      return *stop;
    }
    pollfd ended{process_.descriptor(), POLLIN, 0};
    if (::poll(&ended, 1, 0) != 1) continue;
    while (socket_open_) read_lines();
    const ExitStatus status = process_.wait();
    watch_.on_exit(status);
    return end_of(status);
  }
}

void Conversation::wait_for_something() const {
  const auto left = std::chrono::ceil<milliseconds>(deadline_ - Clock::now());
  const auto timeout = std::clamp(left, milliseconds(0), kAskEvery);
  std::array<pollfd, 3> entries{{{process_.descriptor(), POLLIN, 0},
                                 {watch_.interrupt.descriptor(), POLLIN, 0},
                                 {socket_open_ ? socket_ : -1, POLLIN, 0}}};
  ::poll(entries.data(), entries.size(), static_cast<int>(timeout.count()));
}

void Conversation::read_lines() {
  pollfd ready{socket_, POLLIN, 0};
  if (::poll(&ready, 1, 0) != 1) {
    // Asked again only after the process has ended: then nothing more can come.
    pollfd ended{process_.descriptor(), POLLIN, 0};
    if (::poll(&ended, 1, 0) == 1 && ::poll(&ready, 1, 0) != 1) socket_open_ = false;
    return;
  }
  switch (lines_.fill()) {
    case LineReader::Status::end:
      socket_open_ = false;
      break;
    case LineReader::Status::too_long:
      socket_open_ = false;
      broke_protocol_ = true;
      break;
    case LineReader::Status::data:
    case LineReader::Status::again:
      break;
  }
  while (const auto line = lines_.next()) hear(*line);
}

void Conversation::hear(const std::string& line) {
  auto event = parse_worker_event(line);
  if (!event) {
    watch_.on_text(line);
    return;
  }
  if (last_) {
    broke_protocol_ = true;
    return;
  }
  if (const auto* progress = std::get_if<Progress>(&*event)) {
    decoded_ = decoded_ || progress->stage != kDecodeStage;
    watch_.on_progress(*progress);
    return;
  }
  last_ = std::move(*event);
  deadline_ = std::min(deadline_, Clock::now() + kLeaveWithin);
}

std::optional<WorkerEnd> Conversation::reason_to_stop() {
  if (broke_protocol_) {
    return WorkerDied{{ErrorCode::worker_crashed, "The worker did not keep to its protocol."},
                      "broke the protocol"};
  }
  if (!watch_.keep_going()) return WorkerStopped{};
  if (Clock::now() >= deadline_) {
    if (last_) {
      return WorkerDied{{ErrorCode::worker_crashed, "The worker did not end."}, "did not exit"};
    }
    return Failed{time_limit("deadline")};
  }
  return std::nullopt;
}

WorkerEnd Conversation::end_of(ExitStatus status) {
  if (status.signal != 0) return end_of_signal(status);
  if (last_ && std::holds_alternative<Failed>(*last_)) return std::get<Failed>(*last_);
  if (last_ && status.code == 0) return std::get<Finished>(*last_);
  if (status.code == problem_kind(ErrorCode::memory_limit).exit_code) {
    return WorkerDied{{ErrorCode::memory_limit,
                       "The job needs more memory than a job may use: send a smaller mesh."},
                      "memory limit"};
  }
  return WorkerDied{{ErrorCode::worker_crashed, "The worker ended without a result."},
                    fmt::format("exit code {}", status.code)};
}

WorkerEnd Conversation::end_of_signal(const ExitStatus& status) const {
  // The kernel ends a process at its soft limit with SIGXCPU, at its hard limit with SIGKILL.
  const bool used_up = status.signal == SIGKILL && status.processor_time >= cpu_limit_ - kTick;
  if (status.signal == SIGXCPU || used_up) return Failed{time_limit("limit of processor time")};
  if (status.signal == SIGXFSZ) {
    return Failed{{ErrorCode::too_large,
                   "The result is larger than a result may be: ask for fewer attributes, a "
                   "compressed output, or another format."}};
  }
  const std::string how = status.signal == SIGSYS
                              ? fmt::format("forbidden system call (signal {})", SIGSYS)
                              : fmt::format("signal {}", status.signal);
  // SIGKILL comes from outside: from the kernel, short of memory, or from somebody.
  if (!decoded_ && status.signal != SIGKILL) {
    return WorkerDied{{ErrorCode::decoder_failed,
                       fmt::format("The process that decoded the input was ended, twice, by a {}: "
                                   "the file is damaged in a way that no reader may survive; "
                                   "write it anew with another program.",
                                   how)},
                      how};
  }
  return WorkerDied{{ErrorCode::worker_crashed,
                     fmt::format("The worker was ended, twice, by a {}: this input may have met a "
                                 "defect of fairway.",
                                 how)},
                    how};
}

}  // namespace

Result<WorkerEnd> run_worker(WorkerPool& pool, const WorkerTask& task, const WorkerWatch& watch) {
  auto worker = engage(pool, task);
  if (!worker) return worker.error();
  return Conversation(task, watch, worker->process, worker->socket.get()).follow();
}

}  // namespace fairway
