// Preloaded into fairwayd: does what the files in $FAIRWAY_FAULTS say. `clock` holds seconds that
// the wall clock is ahead, `spawn` lets no process start.
#include <cerrno>
#include <cstdlib>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

namespace {

std::string place(const char* name) {
  static const char* const folder = std::getenv("FAIRWAY_FAULTS");
  return std::string(folder != nullptr ? folder : "/nonexistent") + "/" + name;
}

/// The function that stands behind ours.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

time_t seconds_ahead() {
  static const std::string path = place("clock");
  const int before = errno;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  char text[32] = {};
  if (fd >= 0) {
    if (::read(fd, text, sizeof text - 1) < 0) text[0] = '\0';
    ::close(fd);
  }
  errno = before;
  return std::strtol(text, nullptr, 10);
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* at) noexcept {
  static auto* const real = next<int(clockid_t, timespec*)>("clock_gettime");
  const int result = real(clock, at);
  if (result == 0 && clock == CLOCK_REALTIME) at->tv_sec += seconds_ahead();
  return result;
}

int gettimeofday(timeval* at, void* zone) noexcept {
  static auto* const real = next<int(timeval*, void*)>("gettimeofday");
  const int result = real(at, zone);
  if (result == 0) at->tv_sec += seconds_ahead();
  return result;
}

time_t time(time_t* at) noexcept {
  static auto* const real = next<time_t(time_t*)>("time");
  const time_t now = real(nullptr) + seconds_ahead();
  if (at != nullptr) *at = now;
  return now;
}

int posix_spawn(pid_t* pid, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const arguments[],
                char* const environment[]) {
  static auto* const real =
      next<int(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*,
               char* const*, char* const*)>("posix_spawn");
  if (::access(place("spawn").c_str(), F_OK) == 0) return EAGAIN;
  return real(pid, path, actions, attributes, arguments, environment);
}
}
