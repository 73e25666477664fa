#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "core/result.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/work/job_board.h"

namespace fairway {

/// How often who waits for a job looks whether its client is still there.
inline constexpr std::chrono::milliseconds kLookForClient{200};
/// How often the store is asked although the board announced nothing: a lease may have run out.
inline constexpr std::chrono::milliseconds kLookForChange{1000};

/// What a wait for a job looks at. All references must outlive it.
struct JobWatch {
  JobStore& jobs;
  const JobBoard& board;
  std::stop_token stop;
  std::function<bool()> client_is_there;
};

enum class WaitEnd { reached, time_up, client_gone, stopping };

/// Why a wait ended, and the job as it was last seen.
struct Waited {
  WaitEnd end = WaitEnd::reached;
  Job job;
};

/// Blocks until `reached` is true of the job (it is asked first), `until` is past, the client has
/// hung up, or the server stops. `number`: of the job. Errors: as JobStore::find().
Result<Waited> wait_for_job(const JobWatch& watch, std::int64_t number,
                            std::chrono::steady_clock::time_point until,
                            const std::function<bool(const Job&)>& reached);

}  // namespace fairway
