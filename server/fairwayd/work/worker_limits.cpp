#include "server/fairwayd/work/worker_limits.h"

#include <algorithm>

#include "server/fairwayd/uploads/memory_estimate.h"

namespace fairway {

WorkerLimits limits_for(WorkerLimits limits, Format format, std::uint64_t bytes) {
  if (const auto most = most_memory(format, bytes); most && limits.address_space != 0) {
    limits.address_space = std::min(limits.address_space, *most);
  }
  limits.cpu = std::min(limits.cpu, processor_time_within(limits.deadline));
  return limits;
}

}  // namespace fairway
