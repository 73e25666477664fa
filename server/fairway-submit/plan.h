#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/fairway-submit/options.h"

namespace fairway {

/// One file of a batch.
struct BatchFile {
  std::filesystem::path input;
  std::string name;  ///< of its result in --out, different from all others
};

/// Names the results: each has its input's name, with another extension where the parameters choose
/// an output format. Opens no file, so that a missing one fails by itself later. Errors: usage, for
/// two results with one name and for a result that would replace an input.
Result<std::vector<BatchFile>> plan_batch(const SubmitOptions& options);

}  // namespace fairway
