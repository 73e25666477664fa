#include "tests/chaos/scenarios.h"

#include <array>

#include "server/os/kill_point.h"

namespace fairway::chaos {

std::span<const Scenario> scenarios() {
  static const std::array rows = {
      Scenario{"upload", 50, true, kill_during_upload, "server killed at random bytes of uploads"},
      Scenario{"accepted", 100, true, kill_after_accepting, "server killed right after 202"},
      Scenario{"job", 50, true, kill_during_job, "server killed while a job runs"},
      Scenario{"points", kill_point_trials(), false, kill_at_points,
               "server or worker killed at each named point"},
#ifndef FAIRWAY_SANITIZED  // a sanitizer's library will be the first one
      Scenario{"calls", 15, false, kill_at_calls,
               "server killed at each system call of the result write"},
#endif
      Scenario{"worker", 30, true, kill_worker, "worker killed while it works"},
      Scenario{"stopped-worker", 2, true, stop_worker, "worker stopped past the lease"},
      Scenario{"stopped-server", 4, true, stop_server, "server stopped past its lease"},
      Scenario{"lease", 4, true, lose_lease, "server frozen while another host takes its job"},
      Scenario{"restart", 4, false, restart_with_queue, "server killed with 1000 queued jobs"},
      Scenario{"connections", 1, false, hold_connections, "200 idle and 200 slow connections"},
      Scenario{"crowd", 1, false, crowd,
               "1000 small jobs from 16 clients of two tenants, queue full"}};
  return rows;
}

}  // namespace fairway::chaos
