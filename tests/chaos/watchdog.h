#pragma once

#include <chrono>
#include <thread>

#include <sys/types.h>

namespace fairway::chaos {

/// The service that is under test now, or 0: what a watchdog or a signal to the suite kills.
void watch_service(pid_t pid);

/// SIGINT and SIGTERM kill the service under test and let the suite come to its end.
void handle_interrupts();
bool was_interrupted();

/// Kills the service under test when its time is over, so that a wait on it ends.
class Watchdog {
 public:
  explicit Watchdog(std::chrono::seconds time);

 private:
  std::jthread thread_;
};

}  // namespace fairway::chaos
