#include "server/os/event_flag.h"

#include <cerrno>
#include <cstdint>

#include <poll.h>
#include <sys/eventfd.h>

#include "server/os/file.h"

namespace fairway {

Result<EventFlag> EventFlag::create() {
  UniqueFd fd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!fd) return Error{ErrorCode::unavailable, system_sentence("make an event descriptor", errno)};
  return EventFlag(std::move(fd));
}

// EAGAIN is the only failure of a valid eventfd, and says that the flag already is as asked.
void EventFlag::raise() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(fd_.get(), &one, sizeof one);
}

void EventFlag::lower() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(fd_.get(), &count, sizeof count);
}

bool EventFlag::is_raised() const {
  pollfd entry{fd_.get(), POLLIN, 0};
  return ::poll(&entry, 1, 0) == 1;
}

}  // namespace fairway
