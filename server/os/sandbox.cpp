// The allow-list of the worker. What is not on it ends the process: a library that begins to need
// another call must be noticed, and one that meets a planted file must not get any further.

#include "server/os/sandbox.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <linux/capability.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/os/file.h"

namespace fairway {
namespace {

Error cannot(std::string_view doing, int error_number) {
  return {
      error_number == ENOMEM ? ErrorCode::memory_limit : ErrorCode::internal,
      fmt::format("The worker cannot confine itself. {}", system_sentence(doing, error_number))};
}

/// Allowed whatever their arguments. Nothing here reaches what is not open or mapped already.
constexpr std::array kCalls = {
    // memory
    SCMP_SYS(brk), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(futex),
    // what is open
    SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(close),
    // clocks and counts, which the C library reads where the kernel page does not tell them
    SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday), SCMP_SYS(getrandom), SCMP_SYS(sysinfo),
    SCMP_SYS(sched_getaffinity), SCMP_SYS(sched_yield), SCMP_SYS(getpid), SCMP_SYS(gettid),
    // ends: exit, abort(), and going on after a stop
    SCMP_SYS(exit), SCMP_SYS(exit_group), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn),
    SCMP_SYS(restart_syscall)};

/// A rule for one call; without a condition it holds for any arguments.
int allow(scmp_filter_ctx filter, int call, std::optional<scmp_arg_cmp> condition = {}) {
  if (!condition) return seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, 0, nullptr);
  return seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, 1, &*condition);
}

/// Zero, or the negative error number of the first rule that was refused.
int add_rules(scmp_filter_ctx filter) {
  for (const int call : kCalls) {
    if (const int error = allow(filter, call); error != 0) return error;
  }
  const scmp_arg_cmp no_code = {2, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0};
  const scmp_arg_cmp myself = {0, SCMP_CMP_EQ, static_cast<scmp_datum_t>(::getpid()), 0};
  const scmp_arg_cmp no_address = {4, SCMP_CMP_EQ, 0, 0};
  int error = allow(filter, SCMP_SYS(mmap), no_code);
  if (error == 0) error = allow(filter, SCMP_SYS(mprotect), no_code);
  if (error == 0) error = allow(filter, SCMP_SYS(sendto), no_address);
  if (error == 0) error = allow(filter, SCMP_SYS(tgkill), myself);
  return error;
}

/// Never above what is set already: whoever started this process may have been quicker.
bool limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) return false;
  const rlimit both = {std::min(soft, now.rlim_max), std::min(hard, now.rlim_max)};
  return ::setrlimit(resource, &both) == 0;
}

Result<void> set_limits(const SandboxLimits& limits) {
  bool set = limit(RLIMIT_CORE, 0, 0);
  // A sanitizer looks for leaks by a process of its own.
  if (Sandbox::has_filter()) set = set && limit(RLIMIT_NPROC, 0, 0);
  if (limits.address_space != 0) {
    set = set && limit(RLIMIT_AS, limits.address_space, limits.address_space);
  }
  if (limits.cpu_seconds != 0) {
    set = set && limit(RLIMIT_CPU, limits.cpu_seconds, limits.cpu_seconds + 1);
  }
  if (limits.file_bytes != 0) {
    set = set && limit(RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes);
  }
  if (!set) return cannot("set a limit", errno);
  return {};
}

Result<void> drop_capabilities() {
  __user_cap_header_struct header = {_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none = {};
  if (::syscall(SYS_capset, &header, none.data()) != 0) return cannot("drop capabilities", errno);
  return {};
}

}  // namespace

bool Sandbox::has_filter() {
#ifdef FAIRWAY_SANITIZED
  return false;
#else
  return true;
#endif
}

namespace {

struct Release {
  void operator()(void* filter) const { seccomp_release(filter); }
};

/// The bytes of a filter, as the kernel takes them.
Result<std::vector<sock_filter>> compile(scmp_filter_ctx filter) {
  const UniqueFd file(::memfd_create("filter", MFD_CLOEXEC));
  if (!file) return cannot("make a filter", errno);
  if (const int error = seccomp_export_bpf(filter, file.get()); error != 0) {
    return cannot("make a filter", -error);
  }
  const auto bytes = size_of(file.get());
  if (!bytes) return bytes.error();
  std::vector<sock_filter> program(*bytes / sizeof(sock_filter));
  const ssize_t got = ::pread(file.get(), program.data(), *bytes, 0);
  if (got < 0 || static_cast<std::uint64_t>(got) != *bytes) return cannot("read a filter", errno);
  return program;
}

Result<std::vector<sock_filter>> make_filter() {
  const std::unique_ptr<void, Release> filter(seccomp_init(SCMP_ACT_KILL_PROCESS));
  if (!filter) return cannot("make a filter", ENOMEM);
  // Other ways into the kernel (32-bit, x32) are forbidden calls like any other.
  int error = seccomp_attr_set(filter.get(), SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
  if (error == 0) error = add_rules(filter.get());
  if (error != 0) return cannot("make a filter", -error);
  return compile(filter.get());
}

}  // namespace

Result<Sandbox> Sandbox::prepare(const SandboxLimits& limits) {
  const bool separate = ::unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0;
  Sandbox sandbox(separate ? std::string() : system_sentence("leave the namespaces", errno));
  // Behind unshare(), which gives all capabilities within the new namespace.
  if (auto dropped = drop_capabilities(); !dropped) return dropped.error();
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return cannot("give up privileges", errno);
  // Behind both: a change of credentials may clear it.
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return cannot("follow its parent", errno);
  if (has_filter()) {
    auto filter = make_filter();
    if (!filter) return filter.error();
    sandbox.filter_ = *std::move(filter);
  }
  if (auto limited = set_limits(limits); !limited) return limited.error();
  return sandbox;
}

/// The filter was made before: the library that makes it does not bear to find no memory.
Result<void> Sandbox::close() {
  if (filter_.empty()) return {};
  if (!limit(RLIMIT_NOFILE, 0, 0)) return cannot("set a limit", errno);
  const sock_fprog program = {static_cast<unsigned short>(filter_.size()), filter_.data()};
  if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
    return cannot("load the filter", errno);
  }
  return {};
}

}  // namespace fairway
