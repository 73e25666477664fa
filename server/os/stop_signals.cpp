#include "server/os/stop_signals.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "server/os/file.h"

namespace fairway {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

Result<StopSignals> StopSignals::block() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  UniqueFd fd(::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK));
  if (!fd) return Error{ErrorCode::unavailable, system_sentence("wait for signals", errno)};
  return StopSignals(std::move(fd));
}

StopSignals::Woken StopSignals::wait(int flag, std::optional<milliseconds> time) const {
  const auto until = Clock::now() + time.value_or(milliseconds(0));
  while (true) {
    signalfd_siginfo info;
    if (::read(fd_.get(), &info, sizeof info) == sizeof info) return Woken::signal;
    const auto left = std::max(std::chrono::ceil<milliseconds>(until - Clock::now()).count(),
                               milliseconds::rep{0});
    std::array<pollfd, 2> entries{{{fd_.get(), POLLIN, 0}, {flag, POLLIN, 0}}};
    const int ready = ::poll(entries.data(), entries.size(), time ? static_cast<int>(left) : -1);
    if (ready == 0) return Woken::timeout;
    if (ready > 0 && entries[0].revents == 0) return Woken::flag;
  }
}

}  // namespace fairway
