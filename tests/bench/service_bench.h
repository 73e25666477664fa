#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tests/bench/figures.h"
#include "tests/bench/job_client.h"
#include "tests/bench/measured_process.h"

namespace fairway::bench {

struct ServiceOptions {
  int rounds = 15;  ///< of latency
  std::size_t vertices = 35'000;
  std::size_t jobs = 1'000;  ///< before memory is looked at
  std::size_t batch = 40;    ///< jobs of a batch of throughput
  std::size_t clients = 4;
  std::vector<std::string> only;  ///< those wanted; all if empty
  bool json = false;
  bool no_peer = false;
};

/// What the measures share.
struct ServiceBench {
  const ServiceOptions& options;
  const std::filesystem::path folder;
  Uploads& uploads;
  Figures& figures;
};

/// fairwayd over a new directory of this name. Errors: as MeasuredProcess::start().
Result<MeasuredProcess> start_service(const ServiceBench& bench, const std::string& name,
                                      std::optional<unsigned> workers = {});

/// What the service adds to a run of the tool, and a Python service beside it.
Result<void> measure_latency(ServiceBench& bench);

/// Jobs a second with one worker and with two.
Result<void> measure_throughput(ServiceBench& bench);

}  // namespace fairway::bench
