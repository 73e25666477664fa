#include "server/fairwayd/supervisor.h"

#include <utility>

#include <fmt/format.h>

#include "proto/messages/problem.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kLookEvery{1000};
constexpr int kMaxTextLines = 20;
/// A state that cannot be written now (database locked, disk full) is tried again for so long;
/// after that the lease runs out and the job is done again.
constexpr int kWriteAttempts = 20;
constexpr milliseconds kWritePause{250};

bool may_pass(ErrorCode code) {
  return code == ErrorCode::unavailable || code == ErrorCode::storage_full || code == ErrorCode::io;
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

Supervisor::Supervisor(JobStore& jobs, BlobStore& blobs, JobBoard& board, const Log& log,
                       SupervisorOptions options)
    : jobs_(jobs), blobs_(blobs), board_(board), log_(log), options_(std::move(options)) {}

Supervisor::~Supervisor() {
  stop();
}

Result<void> Supervisor::start() {
  for (std::size_t i = 0; i < options_.slots; ++i) {
    auto flag = EventFlag::create();
    if (!flag) return flag.error();
    slots_.push_back(std::make_unique<Slot>(std::move(*flag)));
  }
  for (auto& slot : slots_) {
    slot->thread = std::jthread([this, &slot = *slot](std::stop_token stop) { serve(slot, stop); });
  }
  return {};
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

void Supervisor::interrupt(std::string_view job_id) {
  for (auto& slot : slots_) {
    const std::lock_guard lock(slot->mutex);
    if (slot->job_id != job_id) continue;
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
  run_inspection(*task, {options_.worker, options_.limits, slot.interrupt, log_}, stop);
}

void Supervisor::serve(Slot& slot, std::stop_token stop) {
  while (!stop.stop_requested()) {
    serve_inspection(slot, stop);
    if (stop.stop_requested()) break;
    auto claim = jobs_.claim(options_.owner, options_.lease);
    if (!claim) {
      log_.write(LogLevel::error, "claim_failed", {{"reason", claim.error().message}});
      pause(kLookEvery, stop);
    } else if (*claim) {
      run(slot, **claim, stop);
    } else {
      std::unique_lock lock(mutex_);
      work_.wait_for(lock, stop, kLookEvery, [&] { return wakeups_ > 0 || !inspections_.empty(); });
      if (wakeups_ > 0) --wakeups_;
    }
  }
}

void Supervisor::run(Slot& slot, const Claim& claim, std::stop_token stop) {
  {
    const std::lock_guard lock(slot.mutex);
    slot.job_id = claim.job.id;
    slot.canceled = false;
  }
  // A cancel before this line did not find the slot, but has been written to the store.
  const auto now = jobs_.find(claim.job.id);
  const bool still_ours = !now || now->revision == claim.job.revision;
  if (still_ours) execute(slot, claim, stop);
  const std::lock_guard lock(slot.mutex);
  slot.job_id.clear();
}

void Supervisor::execute(Slot& slot, const Claim& claim, std::stop_token stop) {
  board_.announce();
  log_.write(
      LogLevel::info, "job_started",
      {{"job", claim.job.id}, {"attempt", claim.job.attempt}, {"bytes", claim.job.input.bytes}});
  auto output = blobs_.create();
  if (!output) {
    log_.write(LogLevel::error, "spool_failed",
               {{"job", claim.job.id}, {"reason", output.error().message}});
    hand_back(claim);
    pause(kLookEvery, stop);
  } else if (auto end = run_process(slot, claim, **output, stop); end) {
    settle(claim, std::move(*end), **output, stop);
  } else if (may_pass(end.error().code)) {
    log_.write(LogLevel::error, "worker_not_started",
               {{"job", claim.job.id}, {"reason", end.error().message}});
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

  const WorkerTask task{
      options_.worker, input->get(), output.descriptor(),
      WorkerOrder{claim.job.input_format, std::move(*parameters), claim.job.input_files},
      options_.limits};
  auto next_beat = steady_clock::now() + options_.heartbeat;
  int text_lines = 0;
  const WorkerWatch watch{[&](const Progress& progress) { board_.post(claim.job.id, progress); },
                          [&](std::string_view text) {
                            if (++text_lines > kMaxTextLines) return;
                            log_.write(LogLevel::warning, "worker_text",
                                       {{"job", claim.job.id}, {"text", std::string(text)}});
                          },
                          [&] { return keep_going(slot, claim.lease, next_beat, stop); },
                          slot.interrupt};
  return run_worker(task, watch);
}

bool Supervisor::keep_going(Slot& slot, const Lease& lease, steady_clock::time_point& next_beat,
                            const std::stop_token& stop) {
  slot.interrupt.lower();
  if (stop.stop_requested()) return false;
  {
    const std::lock_guard lock(slot.mutex);
    if (slot.canceled) return false;
  }
  if (steady_clock::now() < next_beat) return true;
  auto beat = jobs_.heartbeat(lease, options_.lease);
  next_beat = steady_clock::now() + options_.heartbeat;
  if (beat) return true;
  log_.write(LogLevel::warning, "heartbeat_failed",
             {{"job", lease.job_id}, {"reason", beat.error().message}});
  // A store that does not answer is no reason to throw work away: the fencing token decides later.
  return beat.error().code != ErrorCode::conflict;
}

void Supervisor::settle(const Claim& claim, WorkerEnd end, BlobDraft& output,
                        const std::stop_token& stop) {
  if (const auto* finished = std::get_if<Finished>(&end)) return succeed(claim, *finished, output);
  if (const auto* failed = std::get_if<Failed>(&end)) return fail(claim, failed->error);
  if (const auto* death = std::get_if<WorkerDied>(&end)) return lose_worker(claim, *death);
  if (stop.stop_requested()) return hand_back(claim);
  log_.write(LogLevel::info, "worker_stopped", {{"job", claim.job.id}});
  board_.forget(claim.job.id);
}

void Supervisor::succeed(const Claim& claim, const Finished& finished, BlobDraft& output) {
  const std::string key = fmt::format("out-{}-{}", claim.job.id, claim.lease.fence);
  auto blob = output.commit(key);
  if (!blob) return fail(claim, blob.error());
  if (blob->bytes == 0) {
    [[maybe_unused]] const auto removed = blobs_.remove(key);  // else swept at the next start
    return lose_worker(
        claim, {{ErrorCode::worker_crashed, "The worker wrote no result."}, "empty output"});
  }
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

void Supervisor::lose_worker(const Claim& claim, const WorkerDied& death) {
  log_.write(LogLevel::warning, "worker_died",
             {{"job", claim.job.id}, {"attempt", claim.job.attempt}, {"how", death.how}});
  conclude(claim, insist([&] { return jobs_.worker_died(claim.lease, death.cause); }));
}

void Supervisor::hand_back(const Claim& claim) {
  conclude(claim, insist([&] { return jobs_.give_back(claim.lease); }));
}

void Supervisor::conclude(const Claim& claim, const Result<Job>& written) {
  board_.forget(claim.job.id);
  if (!written) {
    log_.write(written.error().code == ErrorCode::conflict ? LogLevel::info : LogLevel::error,
               "state_not_written", {{"job", claim.job.id}, {"reason", written.error().message}});
    return;
  }
  board_.announce();
  if (is_final(written->state)) {
    if (auto removed = blobs_.remove(claim.job.input.key); !removed) {
      log_.write(LogLevel::warning, "input_not_removed",
                 {{"job", claim.job.id}, {"reason", removed.error().message}});
    }
  }
  log_.write(LogLevel::info, "job_state",
             {{"job", claim.job.id},
              {"state", name_of(written->state)},
              {"attempt", written->attempt},
              {"revision", written->revision},
              {"problem", written->problem ? problem_kind(written->problem->code).slug : ""}});
}

void Supervisor::pause(milliseconds time, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  work_.wait_for(lock, stop, time, [] { return false; });
}

}  // namespace fairway
