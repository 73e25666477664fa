#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/fairway-submit/file_outcome.h"
#include "server/fairway-submit/options.h"
#include "server/fairway-submit/plan.h"

namespace fairway {

/// What came of a batch.
struct BatchReport {
  std::string batch;                  ///< its id, the same in all runs over one folder
  std::vector<BatchFile> files;       ///< in the order of the command line
  std::vector<FileOutcome> outcomes;  ///< of each
  SubmitExit exit = SubmitExit::all;
  std::chrono::milliseconds took{0};
};

/// Runs a batch to its end, to a lost server or to SIGINT or SIGTERM. Errors: usage (colliding
/// names, a folder or a journal that cannot be used), io, storage_full, unavailable: nothing was
/// started.
Result<BatchReport> run_batch(const SubmitOptions& options);

}  // namespace fairway
