#include "server/fairwayd/work/worker_pool.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "server/os/kill_point.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// How often the program file is looked at.
constexpr milliseconds kLookEvery{1000};
/// A program that does not come up is tried less and less often.
constexpr milliseconds kFirstPause{500};
constexpr milliseconds kLongestPause{30000};
/// A worker that does not read its order cannot hold its supervisor for longer.
constexpr timeval kPatience{5, 0};

ProgramVersion version_of(const std::filesystem::path& program) {
  struct stat status = {};
  if (::stat(program.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino,
          status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec, status.st_size};
}

bool has_ended(const ChildProcess& process) {
  pollfd ended{process.descriptor(), POLLIN, 0};
  return ::poll(&ended, 1, 0) == 1;
}

std::string describe(const ExitStatus& status) {
  return status.signal != 0 ? fmt::format("signal {}", status.signal)
                            : fmt::format("exit code {}", status.code);
}

}  // namespace

WorkerPool::WorkerPool(std::filesystem::path program, const WorkerLimits& limits, std::size_t kept,
                       const Log& log)
    : program_(std::move(program)), limits_(limits), kept_(kept), log_(log) {}

WorkerPool::~WorkerPool() {
  close();
  thread_.request_stop();
  if (changed_) changed_->raise();
}

Result<void> WorkerPool::start() {
  if (kept_ == 0) return {};
  auto flag = EventFlag::create();
  if (!flag) return flag.error();
  changed_.emplace(*std::move(flag));
  fill();  // so that whoever comes first finds the first
  thread_ = std::jthread([this](const std::stop_token& stop) { keep(stop); });
  return {};
}

Result<WaitingWorker> WorkerPool::spawn() const {
  auto ends = socket_pair();
  if (!ends) return ends.error();
  ::setsockopt(ends->first.get(), SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience);
  SpawnRequest request;
  request.program = program_;
  request.arguments = {"worker", "--cpu-seconds", fmt::to_string(limits_.cpu.count())};
  if (limits_.address_space != 0) {
    request.arguments.insert(request.arguments.end(),
                             {"--address-space", fmt::to_string(limits_.address_space)});
  }
  request.environment = KillOrder::of_process().for_next_worker();
  const int socket = ends->second.get();
  request.descriptors = {socket, socket, socket};  // until there are files
  const ProgramVersion version = version_of(program_);
  auto process = ChildProcess::spawn(request);
  if (!process) return process.error();
  return WaitingWorker{*std::move(process), std::move(ends->first), version, false};
}

Result<WaitingWorker> WorkerPool::take() {
  const ProgramVersion now = version_of(program_);
  std::vector<WaitingWorker> unfit;  // they are reaped without the lock
  {
    const std::lock_guard lock(mutex_);
    while (!waiting_.empty()) {
      WaitingWorker worker = std::move(waiting_.front());
      waiting_.pop_front();
      if (changed_) changed_->raise();
      if (worker.version == now && !has_ended(worker.process)) {
        pause_ = milliseconds(0);
        return worker;
      }
      unfit.push_back(std::move(worker));
    }
  }
  return spawn();
}

void WorkerPool::close() {
  std::deque<WaitingWorker> ended;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    ended.swap(waiting_);
  }
}

void WorkerPool::keep(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    changed_->lower();
    drop_unfit();
    fill();
    if (!stop.stop_requested()) wait();
  }
}

/// Those that died, and those of a program that is no more.
void WorkerPool::drop_unfit() {
  const ProgramVersion now = version_of(program_);
  std::vector<WaitingWorker> unfit;
  {
    const std::lock_guard lock(mutex_);
    for (WaitingWorker& worker : std::exchange(waiting_, {})) {
      const bool fit = worker.version == now && !has_ended(worker.process);
      if (fit) {
        waiting_.push_back(std::move(worker));
      } else {
        unfit.push_back(std::move(worker));
      }
    }
  }
  for (WaitingWorker& worker : unfit) {
    if (has_ended(worker.process)) {
      note_failure("waiting_worker_died", describe(worker.process.wait()));
    } else {
      log_.write(LogLevel::info, "worker_program_replaced");
      const std::lock_guard lock(mutex_);
      not_before_ = {};
    }
  }
}

bool WorkerPool::wants_one() {
  const std::lock_guard lock(mutex_);
  return !closed_ && waiting_.size() < kept_ && steady_clock::now() >= not_before_;
}

void WorkerPool::fill() {
  while (wants_one()) {
    auto worker = spawn();
    if (!worker) return note_failure("worker_not_started", worker.error().message);
    worker->was_kept = true;
    const std::lock_guard lock(mutex_);
    if (!closed_) waiting_.push_back(*std::move(worker));
  }
}

void WorkerPool::note_failure(const char* event, const std::string& how) {
  log_.write(LogLevel::warning, event, {{"how", how}});
  const std::lock_guard lock(mutex_);
  pause_ = std::clamp(pause_ * 2, kFirstPause, kLongestPause);
  not_before_ = steady_clock::now() + pause_;
}

/// Until a worker was taken or died, or it is time to look anyway.
void WorkerPool::wait() {
  std::vector<pollfd> entries{{changed_->descriptor(), POLLIN, 0}};
  {
    const std::lock_guard lock(mutex_);
    for (const WaitingWorker& worker : waiting_) {
      entries.push_back({worker.process.descriptor(), POLLIN, 0});
    }
  }
  ::poll(entries.data(), entries.size(), static_cast<int>(kLookEvery.count()));
}

}  // namespace fairway
