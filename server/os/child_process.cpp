#include "server/os/child_process.h"

#include <cerrno>
#include <csignal>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>

// glibc 2.36 declares these functions without C linkage for C++.
extern "C" {
#include <sys/pidfd.h>
}

#include "server/os/file.h"

namespace fairway {
namespace {

/// Owns the two structures of posix_spawn.
class SpawnPlan {
 public:
  SpawnPlan() {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
  ~SpawnPlan() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }

  int give_descriptors(const std::array<int, 3>& descriptors) {
    for (int target = 0; target < 3; ++target) {
      const int error = ::posix_spawn_file_actions_adddup2(
          &actions_, descriptors[static_cast<std::size_t>(target)], target);
      if (error != 0) return error;
    }
    // Libraries open descriptors without close-on-exec; none of them may leak into the child.
    return ::posix_spawn_file_actions_addclosefrom_np(&actions_, 3);
  }

  int reset_signals() {
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    int error = ::posix_spawnattr_setsigmask(&attributes_, &none);
    if (error == 0) error = ::posix_spawnattr_setsigdefault(&attributes_, &all);
    if (error == 0) error = ::posix_spawnattr_setpgroup(&attributes_, 0);
    if (error != 0) return error;
    return ::posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }

  int start(pid_t& pid, const char* program, char* const* arguments, char* const* environment) {
    return ::posix_spawn(&pid, program, &actions_, &attributes_, arguments, environment);
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// The C library's spawn child dup2()s in order, so a source below 3 could be overwritten before it
/// is used: such a source is moved above first. Returns the copies, which must outlive the spawn.
Result<std::vector<UniqueFd>> above_standard(std::array<int, 3>& descriptors) {
  std::vector<UniqueFd> copies;
  for (int& fd : descriptors) {
    if (fd < 0 || fd > 2) continue;
    UniqueFd copy(::fcntl(fd, F_DUPFD_CLOEXEC, 3));
    if (!copy) return Error{ErrorCode::unavailable, system_sentence("copy a descriptor", errno)};
    fd = copy.get();
    copies.push_back(std::move(copy));
  }
  return copies;
}

std::chrono::milliseconds milliseconds_of(const timeval& time) {
  return std::chrono::milliseconds(time.tv_sec * 1000 + time.tv_usec / 1000);
}

}  // namespace

Result<ChildProcess> ChildProcess::spawn(const SpawnRequest& request) {
  std::vector<std::string> arguments{request.program.string()};
  arguments.insert(arguments.end(), request.arguments.begin(), request.arguments.end());
  std::vector<std::string> environment = request.environment;
  std::array<int, 3> descriptors = request.descriptors;
  const auto copies = above_standard(descriptors);
  if (!copies) return copies.error();

  SpawnPlan plan;
  pid_t pid = -1;
  int error = plan.give_descriptors(descriptors);
  if (error == 0) error = plan.reset_signals();
  if (error == 0) {
    error = plan.start(pid, request.program.c_str(), pointers(arguments).data(),
                       pointers(environment).data());
  }
  if (error != 0) {
    const bool scarce = error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE;
    return Error{scarce ? ErrorCode::unavailable : ErrorCode::io,
                 system_sentence(fmt::format("start {}", request.program.string()), error)};
  }
  UniqueFd pidfd(::pidfd_open(pid, 0));
  if (!pidfd) {
    const int reason = errno;
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
    return Error{ErrorCode::unavailable, system_sentence("watch a process", reason)};
  }
  return ChildProcess(pid, std::move(pidfd));
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(other.pid_),
      pidfd_(std::move(other.pidfd_)),
      reaped_(std::exchange(other.reaped_, true)),
      status_(other.status_) {}

ChildProcess::~ChildProcess() {
  if (reaped_) return;
  kill(SIGKILL);
  wait();
}

void ChildProcess::kill(int signal) const {
  // By descriptor: a pid that was reaped may already belong to somebody else.
  if (!reaped_) ::pidfd_send_signal(pidfd_.get(), signal, nullptr, 0);
}

ExitStatus ChildProcess::wait() {
  if (reaped_) return status_;
  int status = 0;
  rusage used{};
  while (::wait4(pid_, &status, 0, &used) < 0 && errno == EINTR) {
  }
  reaped_ = true;
  if (WIFSIGNALED(status)) {
    status_.signal = WTERMSIG(status);
  } else {
    status_.code = WEXITSTATUS(status);
  }
  status_.processor_time = milliseconds_of(used.ru_utime) + milliseconds_of(used.ru_stime);
  status_.peak_resident_bytes = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  return status_;
}

Result<std::pair<UniqueFd, UniqueFd>> socket_pair() {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return Error{ErrorCode::unavailable, system_sentence("make a socket pair", errno)};
  }
  return std::pair(UniqueFd(ends[0]), UniqueFd(ends[1]));
}

}  // namespace fairway
