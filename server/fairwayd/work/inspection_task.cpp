#include "server/fairwayd/work/inspection_task.h"

#include <string>
#include <string_view>
#include <variant>

#include <fcntl.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/store/job_state.h"
#include "server/os/file.h"

namespace fairway {
namespace {

constexpr int kMaxTextLines = 20;

Result<Json> answer_of(const WorkerEnd& end) {
  if (const auto* finished = std::get_if<Finished>(&end)) return finished->report;
  if (const auto* failed = std::get_if<Failed>(&end)) return failed->error;
  if (const auto* death = std::get_if<WorkerDied>(&end)) return death->cause;
  return Error{ErrorCode::unavailable, "The server is stopping: send the mesh again."};
}

Result<WorkerEnd> run_once(const InspectionTask& task, const InspectionSetting& setting,
                           const Log& log, const std::stop_token& stop) {
  const auto nowhere = open_file("/dev/null", O_WRONLY);
  if (!nowhere) return nowhere.error();
  const auto bytes = size_of(task.input());
  if (!bytes) return bytes.error();
  const WorkerTask work{task.input(), nowhere->get(), task.order(),
                        limits_for(setting.limits, task.order().input, *bytes)};
  int text_lines = 0;
  const WorkerWatch watch{
      [](const Progress&) {},
      [&](std::string_view text) {
        if (++text_lines > kMaxTextLines) return;
        log.write(LogLevel::warning, "worker_text", {{"text", std::string(text)}});
      },
      [&] {
        setting.interrupt.lower();
        return !stop.stop_requested() && !task.is_abandoned();
      },
      setting.interrupt,
      [&](const ExitStatus& status) { setting.metrics.worker_ended(status.peak_resident_bytes); }};
  return run_worker(setting.workers, work, watch);
}

}  // namespace

void InspectionTask::answer(Result<Json> answer) {
  {
    const std::lock_guard lock(mutex_);
    answer_ = std::move(answer);
  }
  answered_.notify_all();
}

std::optional<Result<Json>> InspectionTask::wait(std::chrono::milliseconds time,
                                                 std::stop_token stop) {
  std::unique_lock lock(mutex_);
  answered_.wait_for(lock, stop, time, [&] { return answer_.has_value(); });
  return std::exchange(answer_, std::nullopt);
}

void run_inspection(InspectionTask& task, const InspectionSetting& setting, std::stop_token stop) {
  const Log log = setting.log.with({{"trace", task.order().trace}});
  for (int attempt = 1;; ++attempt) {
    const Result<WorkerEnd> end = run_once(task, setting, log, stop);
    const auto* death = end ? std::get_if<WorkerDied>(&*end) : nullptr;
    if (death != nullptr) {
      log.write(LogLevel::warning, "inspecting_worker_died",
                {{"attempt", attempt}, {"how", death->how}});
      if (attempt < kMaxWorkerDeaths) continue;
    }
    Result<Json> answer = end ? answer_of(*end) : Result<Json>(end.error());
    const std::string_view problem = answer ? "" : problem_kind(answer.error().code).slug;
    setting.metrics.inspected(answer ? "succeeded" : problem);
    log.write(LogLevel::info, "inspected", {{"attempt", attempt}, {"problem", problem}});
    return task.answer(std::move(answer));
  }
}

}  // namespace fairway
