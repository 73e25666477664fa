#pragma once

#include <array>

#include "proto/messages/job_document.h"

namespace fairway {

/// The one table of a job's life: true where a job in `from` may become `to`.
///
///     queued ──► running ──► succeeded ──┐
///       ▲ │         │ ├────► failed ─────┼──► expired
///       │ └─────────┼─┴────► canceled ───┘
///       └───────────┘  (lease lost or handed back)
///       failed, canceled ──► queued  (retried)
constexpr bool may_follow(JobState from, JobState to) {
  switch (from) {
    case JobState::queued:
      return to == JobState::running || to == JobState::canceled;
    case JobState::running:
      return to == JobState::succeeded || to == JobState::failed || to == JobState::canceled ||
             to == JobState::queued;
    case JobState::succeeded:
      return to == JobState::expired;
    case JobState::failed:
    case JobState::canceled:
      return to == JobState::expired || to == JobState::queued;
    case JobState::expired:
      return false;
  }
  return false;
}

/// All of them.
inline constexpr std::array kJobStates = {JobState::queued, JobState::running,  JobState::succeeded,
                                          JobState::failed, JobState::canceled, JobState::expired};

/// So many workers may die on a job while their server lives; the last one fails it.
inline constexpr int kMaxWorkerDeaths = 2;

}  // namespace fairway
