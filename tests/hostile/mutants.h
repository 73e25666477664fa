#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/hostile/score.h"

namespace fairway::hostile {

struct MutantOptions {
  std::size_t count = 20000;
  std::uint64_t seed = 1;
  std::size_t in_flight = 2;  ///< workers at a time
};

/// Mutations of good files of every format, each through a worker process of its own as the service
/// starts it. Each worker must end by itself, with success or a problem of the class 4xx; one that
/// meets its limit of processor time or memory is counted apart. A case is a batch of mutants of
/// one format.
void run_mutants(Score& score, const MutantOptions& options);

}  // namespace fairway::hostile
