#include "server/fairwayd/work/supervisor.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/telemetry/stage_clock.h"
#include "server/fairwayd/work/job_log.h"
#include "server/os/kill_point.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kLookEvery{1000};
/// To clear a disk takes somebody a while.
constexpr milliseconds kStoragePause{5000};
constexpr std::uint64_t kShortDisk = std::uint64_t{64} << 20U;
constexpr int kMaxTextLines = 20;
/// A state that cannot be written now (database locked, disk full) is tried again for so long;
/// after that the lease runs out and the job is done again.
constexpr int kWriteAttempts = 20;
constexpr milliseconds kWritePause{250};

bool may_pass(ErrorCode code) {
  return code == ErrorCode::unavailable || code == ErrorCode::storage_full || code == ErrorCode::io;
}

/// A job may ask for less time than the server gives, and a small mesh needs less memory.
WorkerLimits limits_of(const Job& job, WorkerLimits limits) {
  if (job.options.deadline) {
    limits.deadline = std::min<decltype(limits.deadline)>(limits.deadline, *job.options.deadline);
  }
  return limits_for(limits, job.input_format, job.input.bytes);
}

template <class Write>
Result<Job> insist(const Write& write) {
  Result<Job> written = write();
  for (int i = 1; i < kWriteAttempts && !written && may_pass(written.error().code); ++i) {
    std::this_thread::sleep_for(kWritePause);
    written = write();
  }
  return written;
}

}  // namespace

Supervisor::Supervisor(JobStore& jobs, BlobStore& blobs, JobBoard& board, WorkerPool& workers,
                       ServiceMetrics& metrics, const Log& log, SupervisorOptions options)
    : jobs_(jobs),
      blobs_(blobs),
      board_(board),
      workers_(workers),
      metrics_(metrics),
      log_(log),
      options_(std::move(options)) {}

Supervisor::~Supervisor() {
  stop();
}

Result<void> Supervisor::start() {
  for (std::size_t i = 0; i < options_.slots; ++i) {
    auto flag = EventFlag::create();
    if (!flag) return flag.error();
    slots_.push_back(std::make_unique<Slot>(std::move(*flag)));
  }
  {
    const std::lock_guard lock(mutex_);
    serving_ = slots_.size();
  }
  for (auto& slot : slots_) {
    slot->thread = std::jthread([this, &slot = *slot](std::stop_token stop) { serve(slot, stop); });
  }
  return {};
}

void Supervisor::drain(const EventFlag& idle) {
  {
    const std::lock_guard lock(mutex_);
    idle_ = &idle;
    if (serving_ == 0) idle.raise();
  }
  work_.notify_all();
}

bool Supervisor::is_draining() {
  const std::lock_guard lock(mutex_);
  return idle_ != nullptr;
}

/// A slot has ended.
void Supervisor::leave() {
  const std::lock_guard lock(mutex_);
  if (--serving_ == 0 && idle_ != nullptr) idle_->raise();
}

void Supervisor::stop() {
  for (auto& slot : slots_) {
    slot->thread.request_stop();
    slot->interrupt.raise();
  }
  slots_.clear();  // joins
}

void Supervisor::wake() {
  {
    const std::lock_guard lock(mutex_);
    ++wakeups_;
  }
  work_.notify_one();
}

void Supervisor::interrupt(std::int64_t job) {
  for (auto& slot : slots_) {
    const std::lock_guard lock(slot->mutex);
    if (slot->job != job) continue;
    slot->canceled = true;
    slot->interrupt.raise();
  }
}

Result<void> Supervisor::inspect(std::shared_ptr<InspectionTask> task, std::size_t places) {
  {
    const std::lock_guard lock(mutex_);
    if (inspections_.size() >= places) {
      return Error{ErrorCode::queue_full, "The queue is full: try again later."};
    }
    inspections_.push_back(std::move(task));
  }
  work_.notify_one();
  return {};
}

void Supervisor::withdraw(const std::shared_ptr<InspectionTask>& task) {
  task->abandon();
  const std::lock_guard lock(mutex_);
  std::erase(inspections_, task);
}

std::size_t Supervisor::waiting_inspections() {
  const std::lock_guard lock(mutex_);
  return inspections_.size();
}

/// The oldest one, if there is any.
void Supervisor::serve_inspection(Slot& slot, const std::stop_token& stop) {
  std::shared_ptr<InspectionTask> task;
  {
    const std::lock_guard lock(mutex_);
    if (inspections_.empty()) return;
    task = std::move(inspections_.front());
    inspections_.pop_front();
  }
  run_inspection(*task, {workers_, options_.limits, slot.interrupt, metrics_, log_}, stop);
}

void Supervisor::serve(Slot& slot, std::stop_token stop) {
  while (!stop.stop_requested() && !is_draining()) {
    serve_inspection(slot, stop);
    if (stop.stop_requested() || is_draining()) break;
    auto claim = jobs_.claim(options_.owner, options_.lease);
    if (!claim) {
      log_.write(LogLevel::error, "claim_failed", {{"reason", claim.error().message}});
      pause(kLookEvery, stop);
    } else if (*claim) {
      run(slot, **claim, stop);
    } else {
      wait_for_work(stop);
    }
  }
  leave();
}

void Supervisor::wait_for_work(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  work_.wait_for(lock, stop, kLookEvery,
                 [&] { return wakeups_ > 0 || !inspections_.empty() || idle_ != nullptr; });
  if (wakeups_ > 0) --wakeups_;
}

void Supervisor::run(Slot& slot, const Claim& claim, std::stop_token stop) {
  {
    const std::lock_guard lock(slot.mutex);
    slot.job = claim.job.number;
    slot.canceled = false;
  }
  // A cancel before this line did not find the slot, but has been written to the store.
  const auto now = jobs_.find(claim.job.number);
  const bool still_ours = !now || now->revision == claim.job.revision;
  if (still_ours) execute(slot, claim, stop);
  const std::lock_guard lock(slot.mutex);
  slot.job = 0;
}

void Supervisor::execute(Slot& slot, const Claim& claim, std::stop_token stop) {
  board_.announce();
  kill_point("claim.committed");
  const Log log = about(log_, claim.job);
  log.write(LogLevel::info, "job_started",
            {{"attempt", claim.job.attempt}, {"bytes", claim.job.input.bytes}});
  auto output = blobs_.create();
  if (!output) {
    try_later(claim, output.error(), stop);
  } else if (auto end = run_process(slot, claim, **output, stop); end) {
    settle(claim, std::move(*end), **output, stop);
  } else if (may_pass(end.error().code)) {
    log.write(LogLevel::error, "worker_not_started", {{"reason", end.error().message}});
    hand_back(claim);
    pause(kLookEvery, stop);
  } else {
    fail(claim, end.error());
  }
}

Result<WorkerEnd> Supervisor::run_process(Slot& slot, const Claim& claim, BlobDraft& output,
                                          std::stop_token stop) {
  auto input = blobs_.open(claim.job.input.key);
  if (!input) return Error{ErrorCode::internal, "The stored input of the job cannot be read."};
  auto parameters = parse_parameters(claim.job.parameters);
  if (!parameters) return parameters.error();

  WorkerOrder order{claim.job.input_format, std::move(*parameters), claim.job.input_files};
  order.trace = claim.job.trace_id;
  return follow(slot, claim,
                {input->get(), output.descriptor(), order, limits_of(claim.job, options_.limits)},
                stop);
}

Result<WorkerEnd> Supervisor::follow(Slot& slot, const Claim& claim, const WorkerTask& task,
                                     const std::stop_token& stop) {
  const auto began = steady_clock::now();
  auto next_beat = began + options_.heartbeat;
  int text_lines = 0;
  StageClock stages;
  const WorkerWatch watch{
      [&](const Progress& progress) {
        stages.enter(progress.stage);
        board_.post(claim.job.number, progress);
      },
      [&](std::string_view text) {
        if (++text_lines > kMaxTextLines) return;
        about(log_, claim.job)
            .write(LogLevel::warning, "worker_text", {{"text", std::string(text)}});
      },
      [&] { return keep_going(slot, claim, next_beat, stop); }, slot.interrupt,
      [&](const ExitStatus& status) { metrics_.worker_ended(status.peak_resident_bytes); }};
  auto end = run_worker(workers_, task, watch);
  if (end && std::holds_alternative<Finished>(*end)) {
    const auto took =
        std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now() - began);
    metrics_.job_ran(took, stages.finish());
    board_.keep_stages(claim.job.number, stages.finish());
  }
  return end;
}

bool Supervisor::keep_going(Slot& slot, const Claim& claim, steady_clock::time_point& next_beat,
                            const std::stop_token& stop) {
  slot.interrupt.lower();
  if (stop.stop_requested()) return false;
  {
    const std::lock_guard lock(slot.mutex);
    if (slot.canceled) return false;
  }
  if (steady_clock::now() < next_beat) return true;
  auto beat = jobs_.heartbeat(claim.lease, options_.lease);
  next_beat = steady_clock::now() + options_.heartbeat;
  if (beat) return true;
  about(log_, claim.job)
      .write(LogLevel::warning, "heartbeat_failed", {{"reason", beat.error().message}});
  // A store that does not answer is no reason to throw work away: the fencing token decides later.
  return beat.error().code != ErrorCode::conflict;
}

void Supervisor::settle(const Claim& claim, WorkerEnd end, BlobDraft& output,
                        const std::stop_token& stop) {
  if (const auto* finished = std::get_if<Finished>(&end)) {
    return succeed(claim, *finished, output, stop);
  }
  if (const auto* failed = std::get_if<Failed>(&end)) {
    const bool no_room = failed->error.code == ErrorCode::storage_full && disk_is_short(claim.job);
    return no_room ? try_later(claim, failed->error, stop) : fail(claim, failed->error);
  }
  if (const auto* death = std::get_if<WorkerDied>(&end)) return lose_worker(claim, *death);
  if (stop.stop_requested()) return hand_back(claim);
  about(log_, claim.job).write(LogLevel::info, "worker_stopped");
  board_.forget(claim.job.number);
}

void Supervisor::succeed(const Claim& claim, const Finished& finished, BlobDraft& output,
                         const std::stop_token& stop) {
  kill_point("worker.reaped");
  // The number makes it one of its kind: tenants may use the same ids.
  const std::string key =
      fmt::format("out-{}-{}-{}", claim.job.number, claim.lease.fence, claim.job.id);
  auto blob = output.commit(key);
  if (!blob) {
    return may_pass(blob.error().code) ? try_later(claim, blob.error(), stop)
                                       : fail(claim, blob.error());
  }
  if (blob->bytes == 0) {
    [[maybe_unused]] const auto removed = blobs_.remove(key);  // else swept at the next start
    return lose_worker(
        claim, {{ErrorCode::worker_crashed, "The worker wrote no result."}, "empty output"});
  }
  kill_point("result.adopted");
  const Success success{*blob, finished.output, dump_json(finished.report)};
  auto written = insist([&] { return jobs_.finish(claim.lease, success); });
  if (!written && written.error().code == ErrorCode::conflict) {
    [[maybe_unused]] const auto removed = blobs_.remove(key);
  }
  conclude(claim, written);
}

void Supervisor::fail(const Claim& claim, const Error& error) {
  conclude(claim, insist([&] { return jobs_.finish(claim.lease, error); }));
}

/// Whether it can be true that a worker found no room: what it says alone must not bring it back.
bool Supervisor::disk_is_short(const Job& job) {
  const auto left = blobs_.free_bytes();
  return !left || *left < kShortDisk + 4 * job.input.bytes;
}

/// The disk has no room for a result, or does not take it: the machine's trouble, not the job's.
void Supervisor::try_later(const Claim& claim, const Error& error, const std::stop_token& stop) {
  about(log_, claim.job).write(LogLevel::error, "storage_failed", {{"reason", error.message}});
  hand_back(claim);
  pause(kStoragePause, stop);
}

void Supervisor::lose_worker(const Claim& claim, const WorkerDied& death) {
  about(log_, claim.job)
      .write(LogLevel::warning, "worker_died",
             {{"attempt", claim.job.attempt}, {"how", death.how}});
  conclude(claim, insist([&] { return jobs_.worker_died(claim.lease, death.cause); }));
}

void Supervisor::hand_back(const Claim& claim) {
  conclude(claim, insist([&] { return jobs_.give_back(claim.lease); }));
}

void Supervisor::conclude(const Claim& claim, const Result<Job>& written) {
  board_.forget(claim.job.number);
  const Log log = about(log_, claim.job);
  if (!written) {
    const bool late = written.error().code == ErrorCode::conflict;
    log.write(late ? LogLevel::info : LogLevel::error, "state_not_written",
              {{"reason", written.error().message}});
    return;
  }
  board_.announce();
  kill_point("result.announced");
  const std::string_view problem =
      written->problem ? problem_kind(written->problem->code).slug : "";
  if (is_final(written->state)) {
    metrics_.job_ended(
        problem.empty() ? name_of(written->state) : problem,
        milliseconds(written->finished.value_or(written->created) - written->created));
  }
  log.write(LogLevel::info, "job_state",
            {{"state", name_of(written->state)},
             {"attempt", written->attempt},
             {"revision", written->revision},
             {"problem", problem}});
}

void Supervisor::pause(milliseconds time, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  work_.wait_for(lock, stop, time, [this] { return idle_ != nullptr; });
}

}  // namespace fairway
