#pragma once

#include <stop_token>
#include <string>

#include "core/result.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/work/worker_run.h"

namespace fairway {

/// An octahedron as the bytes of a GLB: a whole mesh of the smallest size.
std::string canary_glb();

/// Sends the canary the way of a job: a worker with the limits of one denoises it from spool file
/// to spool file. Nothing is kept. Errors: what kept it from coming back, unavailable where a stop
/// was requested meanwhile.
Result<void> run_canary(BlobStore& blobs, WorkerPool& workers, const WorkerLimits& limits,
                        const std::stop_token& stop);

}  // namespace fairway
