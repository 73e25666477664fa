#include "server/fairwayd/api/job_events.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr const char* kProgress = "progress";

std::string progress_text(const Json& document) {
  const auto found = document.find(kProgress);
  return found == document.end() ? std::string() : dump_json(*found);
}

}  // namespace

std::string event_text(std::string_view event, std::string_view id, std::string_view data) {
  std::string text = fmt::format("event: {}\n", event);
  if (!id.empty()) text += fmt::format("id: {}\n", id);
  while (true) {
    const std::size_t end = data.find('\n');
    text += fmt::format("data: {}\n", data.substr(0, end));
    if (end == std::string_view::npos) return text + "\n";
    data.remove_prefix(end + 1);
  }
}

JobEvents::JobEvents(JobWatch watch, std::function<Json(const Job&)> document,
                     std::optional<std::int64_t> seen, EventPace pace)
    : watch_(std::move(watch)),
      document_(std::move(document)),
      seen_(seen),
      pace_(pace),
      next_heartbeat_(Clock::now() + pace.heartbeat) {}

bool JobEvents::emit(const BodySink& sink, std::string_view text) {
  next_heartbeat_ = Clock::now() + pace_.heartbeat;
  return sink(text);
}

bool JobEvents::send_state(const Job& job, const BodySink& sink) {
  if (seen_ == job.revision) return true;
  seen_ = job.revision;
  const Json document = document_(job);
  last_progress_ = progress_text(document);
  return emit(sink, event_text("state", fmt::to_string(job.revision), dump_json(document)));
}

bool JobEvents::send_progress(const Job& job, const BodySink& sink) {
  if (job.state != JobState::running || Clock::now() < next_progress_) return true;
  next_progress_ = Clock::now() + pace_.progress;
  std::string progress = progress_text(document_(job));
  if (progress.empty() || progress == last_progress_) return true;
  last_progress_ = std::move(progress);
  return emit(sink, event_text(kProgress, "", last_progress_));
}

/// Until the board says that something changed, or it is time to ask the store anyway. False: the
/// stream ends.
bool JobEvents::wait(const Job& job, std::uint64_t turn, const BodySink& sink) {
  const auto look_again = Clock::now() + kLookForChange;
  const bool runs = job.state == JobState::running;
  do {
    if (!watch_.client_is_there() || watch_.stop.stop_requested()) return false;
    if (!send_progress(job, sink)) return false;
    if (Clock::now() >= next_heartbeat_ && !emit(sink, ":\n\n")) return false;
    const auto most = std::min(runs ? pace_.progress : kLookForClient, pace_.heartbeat);
    watch_.board.wait(turn, most, watch_.stop);
  } while (watch_.board.turn() == turn && Clock::now() < look_again);
  return true;
}

void JobEvents::send(std::int64_t number, const BodySink& sink) {
  // A first line tells proxies and clients that the stream has begun, whatever the job does.
  if (!emit(sink, ":\n\n")) return;
  while (true) {
    const std::uint64_t turn = watch_.board.turn();
    const auto job = watch_.jobs.find(number);
    if (!job || !send_state(*job, sink) || is_final(job->state)) return;
    if (!wait(*job, turn, sink)) return;
  }
}

}  // namespace fairway
