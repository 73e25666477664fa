#pragma once

#include <cstddef>
#include <cstdint>

#include "core/result.h"
#include "tests/bench/job_client.h"
#include "tests/bench/measured_process.h"

namespace fairway::bench {

/// What a load came to.
struct LoadRun {
  std::size_t jobs = 0;
  double seconds = 0.0;
  ProcessorTime used;

  double rate() const { return static_cast<double>(jobs) / seconds; }
};

/// Sends all uploads to POST /v1/denoise, several clients at a time, each with one connection.
/// The jobs are deleted afterwards, outside the measure. Errors: as follow_job().
Result<LoadRun> run_load(const MeasuredProcess& server, const std::vector<Bytes>& uploads,
                         std::size_t clients);

/// Sends so many uploads, deleting each job once its mesh is there. Errors: as follow_job().
Result<void> run_jobs(const MeasuredProcess& server, Uploads& uploads, std::size_t jobs,
                      std::size_t clients);

}  // namespace fairway::bench
