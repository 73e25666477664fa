#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "proto/messages/json.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/work/job_wait.h"

namespace fairway {

inline constexpr std::string_view kEventStreamType = "text/event-stream";

/// One event of a text/event-stream; `id` empty: the event has none.
std::string event_text(std::string_view event, std::string_view id, std::string_view data);

/// How often what may come.
struct EventPace {
  std::chrono::milliseconds progress{100};     ///< shortest time between two progress events
  std::chrono::milliseconds heartbeat{15000};  ///< a comment, where nothing else was sent so long
};

/// The life of one job as events: `state` with the job document, whose id is the revision, and
/// `progress` with the document's progress. A state that was passed between two looks is left out.
class JobEvents {
 public:
  /// `document` makes the job document. `seen`: the revision that the client knows already.
  JobEvents(JobWatch watch, std::function<Json(const Job&)> document,
            std::optional<std::int64_t> seen, EventPace pace = {});

  /// Sends events until the job is final, it is gone, the client is, or the server stops.
  void send(std::int64_t number, const BodySink& sink);

 private:
  using Clock = std::chrono::steady_clock;

  bool emit(const BodySink& sink, std::string_view text);
  bool send_state(const Job& job, const BodySink& sink);
  bool send_progress(const Job& job, const BodySink& sink);
  bool wait(const Job& job, std::uint64_t turn, const BodySink& sink);

  JobWatch watch_;
  std::function<Json(const Job&)> document_;
  std::optional<std::int64_t> seen_;
  EventPace pace_;
  std::string last_progress_;
  Clock::time_point next_progress_;
  Clock::time_point next_heartbeat_;
};

}  // namespace fairway
