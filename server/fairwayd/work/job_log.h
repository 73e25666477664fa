#pragma once

#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/telemetry/log.h"

namespace fairway {

/// The log with the id of a job and of its trace in every line.
inline Log about(const Log& log, const Job& job) {
  return log.with({{"job", job.id}, {"trace", job.trace_id}});
}

}  // namespace fairway
