// Preloaded into a worker: once it has read something, the allocation that
// $FAIRWAY_FAULT_ALLOCATION numbers finds no memory; with a "+" behind the number all that follow
// neither.
#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

// NOLINTBEGIN(readability-identifier-naming): glibc names them.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
}
// NOLINTEND(readability-identifier-naming)

namespace {

std::atomic<bool> counting = false;
std::atomic<long> allocations = 0;
long wanted = 0;
bool for_good = false;

__attribute__((constructor)) void read_order() {
  const char* const text = std::getenv("FAIRWAY_FAULT_ALLOCATION");
  if (text == nullptr) return;
  char* end = nullptr;
  wanted = std::strtol(text, &end, 10);
  for_good = *end == '+';
}

bool fails() {
  if (!counting) return false;
  const long number = ++allocations;
  const bool is_it = number == wanted || (for_good && number > wanted);
  if (is_it) errno = ENOMEM;
  return is_it;
}

}  // namespace

extern "C" {

ssize_t read(int fd, void* bytes, size_t size) {
  static auto* const real =
      reinterpret_cast<ssize_t (*)(int, void*, size_t)>(::dlsym(RTLD_NEXT, "read"));
  const ssize_t got = real(fd, bytes, size);
  if (fd == STDERR_FILENO) counting = true;
  return got;
}

ssize_t recvmsg(int fd, msghdr* message, int flags) {
  static auto* const real =
      reinterpret_cast<ssize_t (*)(int, msghdr*, int)>(::dlsym(RTLD_NEXT, "recvmsg"));
  const ssize_t got = real(fd, message, flags);
  if (fd == STDERR_FILENO) counting = true;
  return got;
}

void* malloc(size_t size) noexcept {
  return fails() ? nullptr : __libc_malloc(size);
}

void* calloc(size_t count, size_t size) noexcept {
  return fails() ? nullptr : __libc_calloc(count, size);
}

void* realloc(void* block, size_t size) noexcept {
  return fails() ? nullptr : __libc_realloc(block, size);
}

void* aligned_alloc(size_t alignment, size_t size) noexcept {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}

int posix_memalign(void** block, size_t alignment, size_t size) noexcept {
  *block = fails() ? nullptr : __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}
