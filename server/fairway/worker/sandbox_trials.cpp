// One trial per class of calls. The raw system call is made, whatever detour the C library takes.

#include "server/fairway/worker/sandbox_trials.h"

#include <array>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/shapes.h"
#include "proto/formats/fresh_mesh.h"
#include "server/fairway/pipeline.h"

namespace fairway {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kMuch = std::size_t{64} << 20U;

/// True in the parent once its child has ended well; ends the child.
bool ends_well(pid_t child) {
  if (child == 0) _exit(0);
  int status = -1;
  return child > 0 && ::waitpid(child, &status, 0) == child && status == 0;
}

bool open_file() {
  return ::syscall(SYS_openat, AT_FDCWD, "/etc/passwd", O_RDONLY | O_CLOEXEC) >= 0;
}

bool look_for_file() {
  std::array<char, 512> about = {};  // at least a struct stat
  return ::syscall(SYS_newfstatat, AT_FDCWD, "/etc/passwd", about.data(), 0) == 0;
}

bool make_socket() {
  return ::syscall(SYS_socket, AF_INET, SOCK_STREAM, 0) >= 0;
}

bool connect_socket() {
  const sockaddr nowhere = {AF_UNSPEC, {}};
  // What it answers is no matter: it was let through.
  ::syscall(SYS_connect, -1, &nowhere, sizeof nowhere);
  return true;
}

bool execute() {
  std::array<char*, 1> none = {nullptr};
  ::syscall(SYS_execve, "/bin/true", none.data(), none.data());
  return false;
}

bool start_process() {
  return ends_well(static_cast<pid_t>(::syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0)));
}

bool start_process_anew() {
  struct {
    std::uint64_t flags, pidfd, child_tid, parent_tid, exit_signal, stack, stack_size, tls;
  } arguments = {};
  arguments.exit_signal = SIGCHLD;
  return ends_well(static_cast<pid_t>(::syscall(SYS_clone3, &arguments, sizeof arguments)));
}

bool change_itself() {
  return ::syscall(SYS_prctl, PR_SET_DUMPABLE, 0, 0, 0, 0) == 0;
}

bool map_code() {
  return ::mmap(nullptr, kPage, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) !=
         MAP_FAILED;
}

bool make_code() {
  void* page = ::mmap(nullptr, kPage, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return page != MAP_FAILED && ::mprotect(page, kPage, PROT_READ | PROT_EXEC) == 0;
}

bool trace_process() {
  return ::syscall(SYS_ptrace, PTRACE_TRACEME, 0, 0, 0) == 0;
}

bool signal_parent() {
  return ::syscall(SYS_kill, ::getppid(), 0) == 0;
}

bool signal_thread_of_parent() {
  return ::syscall(SYS_tgkill, ::getppid(), ::getppid(), 0) == 0;
}

bool copy_descriptor() {
  return ::syscall(SYS_dup, 1) >= 0;
}

bool raise_limit() {
  rlimit now = {};
  return ::syscall(SYS_prlimit64, 0, RLIMIT_CPU, nullptr, &now) == 0;
}

bool leave_namespaces() {
  return ::syscall(SYS_unshare, CLONE_FILES) == 0;
}

constexpr std::array kForbidden = {
    SandboxTrial{"open a file", open_file},
    SandboxTrial{"look whether a file is there", look_for_file},
    SandboxTrial{"make a socket", make_socket},
    SandboxTrial{"connect", connect_socket},
    SandboxTrial{"execute a program", execute},
    SandboxTrial{"fork", start_process},
    SandboxTrial{"fork by clone3", start_process_anew},
    SandboxTrial{"prctl", change_itself},
    SandboxTrial{"map memory as code", map_code},
    SandboxTrial{"make memory code", make_code},
    SandboxTrial{"ptrace", trace_process},
    SandboxTrial{"signal another process", signal_parent},
    SandboxTrial{"signal another process by tgkill", signal_thread_of_parent},
    SandboxTrial{"copy a descriptor", copy_descriptor},
    SandboxTrial{"touch its limits", raise_limit},
    SandboxTrial{"unshare", leave_namespaces},
};

bool allocate() {
  std::vector<char> memory(kMuch);
  std::memset(memory.data(), 1, memory.size());
  return memory[kMuch / 2] == 1;
}

bool catch_exception() {
  try {
    return std::vector<int>().at(1) == 0;
  } catch (const std::out_of_range&) {
    return true;
  }
}

bool write_output() {
  constexpr char kLine[] = "";
  return ::write(STDOUT_FILENO, kLine, 0) == 0;
}

bool denoise_mesh() {
  Surface surface;
  surface.mesh = with_normal_noise(torus(24, 12, 1.0, 0.4), 0.2, 1);
  const auto file = write_fresh_mesh(surface, {}, Format::glb, {});
  if (!file) return false;
  const std::vector<std::byte> bytes = file->bytes.joined();
  const auto result = run_pipeline(bytes, Format::glb, {}, {}, {});
  return result && result->bytes.size() > 0;
}

constexpr std::array kAllowed = {
    SandboxTrial{"64 MiB of memory", allocate},
    SandboxTrial{"an exception", catch_exception},
    SandboxTrial{"write to what is open", write_output},
    SandboxTrial{"denoise a mesh", denoise_mesh},
};

}  // namespace

std::span<const SandboxTrial> forbidden_trials() {
  return kForbidden;
}

std::span<const SandboxTrial> allowed_trials() {
  return kAllowed;
}

}  // namespace fairway
