#include "server/fairwayd/work/job_board.h"

#include <utility>

namespace fairway {
namespace {

constexpr std::size_t kStagesKept = 1000;

}  // namespace

void JobBoard::post(std::int64_t job, const Progress& progress) {
  const std::lock_guard lock(mutex_);
  progress_[job] = progress;
}

void JobBoard::forget(std::int64_t job) {
  const std::lock_guard lock(mutex_);
  progress_.erase(job);
}

std::optional<Progress> JobBoard::progress(std::int64_t job) const {
  const std::lock_guard lock(mutex_);
  const auto found = progress_.find(job);
  if (found == progress_.end()) return std::nullopt;
  return found->second;
}

void JobBoard::keep_stages(std::int64_t job, StageTimes stages) {
  const std::lock_guard lock(mutex_);
  if (stages_.insert_or_assign(job, std::move(stages)).second) stages_kept_.push_back(job);
  if (stages_kept_.size() <= kStagesKept) return;
  stages_.erase(stages_kept_.front());
  stages_kept_.pop_front();
}

StageTimes JobBoard::stages(std::int64_t job) const {
  const std::lock_guard lock(mutex_);
  const auto found = stages_.find(job);
  return found == stages_.end() ? StageTimes() : found->second;
}

void JobBoard::announce() {
  {
    const std::lock_guard lock(mutex_);
    ++turn_;
  }
  changed_.notify_all();
}

std::uint64_t JobBoard::turn() const {
  const std::lock_guard lock(mutex_);
  return turn_;
}

void JobBoard::wait(std::uint64_t seen, std::chrono::milliseconds time,
                    std::stop_token stop) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, stop, time, [&] { return turn_ != seen; });
}

}  // namespace fairway
