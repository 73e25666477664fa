// Preloaded into fairwayd: counts the calls that change files once a worker's job has ended, and
// kills the process right before the one that CHAOS_CALL numbers. So the way of a result is cut at
// every system call, those of the database among them, without a hook in the program.
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

/// The one call that is not to be made; 0: none.
long wanted() {
  static const char* const text = std::getenv("CHAOS_CALL");
  static const long number = text == nullptr ? 0 : std::strtol(text, nullptr, 10);
  return number;
}

std::atomic<bool> counting = false;
std::atomic<long> calls = 0;

void count() {
  if (counting && ++calls == wanted()) ::raise(SIGKILL);
}

/// The function that stands behind ours.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Whether a child, which may have ended, worked at a job: others only waited, or tested.
bool was_at_a_job(pid_t child) {
  std::array<char, 64> place = {};
  std::array<char, 32> name = {};
  std::snprintf(place.data(), place.size(), "/proc/%d/comm", child);
  const int fd = ::open(place.data(), O_RDONLY | O_CLOEXEC);
  const bool known = fd >= 0 && ::read(fd, name.data(), name.size() - 1) > 0;
  if (fd >= 0) ::close(fd);
  return known && std::string_view(name.data()) == "fairway-job\n";
}

bool is_regular(int fd) {
  struct stat status {};
  return ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

extern "C" {

pid_t wait4(pid_t pid, int* status, int options, rusage* usage) {
  static auto* const real = next<pid_t(pid_t, int*, int, rusage*)>("wait4");
  const bool counts = was_at_a_job(pid);
  const pid_t ended = real(pid, status, options, usage);
  if (counts) counting = true;
  return ended;
}

ssize_t write(int fd, const void* bytes, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  // Not what is said in the log.
  if (fd > STDERR_FILENO && is_regular(fd)) count();
  return real(fd, bytes, size);
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite64");
  count();
  return real(fd, bytes, size, at);
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  count();
  return real(fd, bytes, size, at);
}

int fsync(int fd) {
  static auto* const real = next<int(int)>("fsync");
  count();
  return real(fd);
}

int fdatasync(int fd) {
  static auto* const real = next<int(int)>("fdatasync");
  count();
  return real(fd);
}

int ftruncate(int fd, off_t size) {
  static auto* const real = next<int(int, off_t)>("ftruncate");
  count();
  return real(fd, size);
}

int ftruncate64(int fd, off_t size) {
  static auto* const real = next<int(int, off_t)>("ftruncate64");
  count();
  return real(fd, size);
}

int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  count();
  return real(from, to);
}

int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  count();
  return real(path);
}
}
