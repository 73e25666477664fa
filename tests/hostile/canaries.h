#pragma once

#include "tests/hostile/score.h"

namespace fairway::hostile {

/// Generated meshes of every format that name files and addresses which must not be touched: a file
/// that is watched, and a port of the loopback that listens.
void run_canaries(Score& score);

/// What walls the kernel says a working worker has.
void run_worker_walls(Score& score);

}  // namespace fairway::hostile
