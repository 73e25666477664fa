#include "tests/chaos/watchdog.h"

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <mutex>

namespace fairway::chaos {
namespace {

// A signal handler reaches nothing else.
std::atomic<pid_t> service_pid = 0;
std::atomic<bool> interrupted = false;
static_assert(std::atomic<pid_t>::is_always_lock_free);

void kill_service() {
  const pid_t pid = service_pid.load();
  if (pid > 0) ::kill(pid, SIGKILL);
}

void on_interrupt(int) {
  interrupted = true;
  kill_service();
}

}  // namespace

void watch_service(pid_t pid) {
  service_pid = pid;
  if (was_interrupted()) kill_service();
}

void handle_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool was_interrupted() {
  return interrupted;
}

Watchdog::Watchdog(std::chrono::seconds time)
    : thread_([time](const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any over;
        std::unique_lock lock(mutex);
        if (!over.wait_for(lock, stop, time, [&] { return stop.stop_requested(); })) kill_service();
      }) {}

}  // namespace fairway::chaos
