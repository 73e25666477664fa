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

SpawnRequest spawn_request(const WorkerTask& task, int socket) {
  SpawnRequest request;
  request.program = task.program;
  request.arguments = {"worker"};
  if (task.limits.address_space != 0) {
    request.arguments.push_back("--address-space");
    request.arguments.push_back(fmt::to_string(task.limits.address_space));
  }
  request.arguments.push_back("--cpu-seconds");
  request.arguments.push_back(fmt::to_string(task.limits.cpu.count()));
  request.environment = KillOrder::of_process().for_next_worker();
  request.descriptors = {task.input, task.output, socket};
  return request;
}

/// The worker sets the same limits on itself before it reads a byte; this is the second lock on the
/// door, and it fails only if the worker has already ended.
void limit_from_outside(pid_t pid, const WorkerLimits& limits) {
  if (limits.address_space != 0) {
    const rlimit space{limits.address_space, limits.address_space};
    ::prlimit(pid, RLIMIT_AS, &space, nullptr);
  }
  const auto seconds = static_cast<rlim_t>(limits.cpu.count());
  const rlimit cpu{seconds, seconds + 1};
  ::prlimit(pid, RLIMIT_CPU, &cpu, nullptr);
}

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

  WorkerEnd follow(const WorkerOrder& order);

 private:
  void send(const std::string& line) const;
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
  std::optional<WorkerEvent> last_;  ///< Finished or Failed, once heard
};

WorkerEnd Conversation::follow(const WorkerOrder& order) {
  // This fails where the worker has ended before reading; what it said until then, and its exit
  // status, tell more than the failure.
  send(format_line(order));
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

void Conversation::send(const std::string& line) const {
  std::string_view rest = line;
  while (!rest.empty()) {
    // A worker that never reads cannot hold the supervisor: an order fits into the socket's buffer
    // in practice, and where it does not, SO_SNDTIMEO ends the wait.
    const ssize_t sent = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;
    rest.remove_prefix(static_cast<std::size_t>(sent));
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
  return WorkerDied{
      {ErrorCode::worker_crashed,
       fmt::format("The worker was ended by signal {}, twice: this input may have met "
                   "a defect of fairway.",
                   status.signal)},
      fmt::format("signal {}", status.signal)};
}

}  // namespace

Result<WorkerEnd> run_worker(const WorkerTask& task, const WorkerWatch& watch) {
  auto ends = socket_pair();
  if (!ends) return ends.error();
  const timeval patience{5, 0};
  ::setsockopt(ends->first.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  auto process = ChildProcess::spawn(spawn_request(task, ends->second.get()));
  if (!process) return process.error();
  ends->second.reset();  // so that the end of the worker is the end of the stream
  limit_from_outside(process->pid(), task.limits);
  kill_point("worker.spawned");
  return Conversation(task, watch, *process, ends->first.get()).follow(task.order);
}

}  // namespace fairway
