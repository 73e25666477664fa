// `fairway worker --self-test-sandbox`.

#include "server/fairway/worker/self_test.h"

#include <csignal>
#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "proto/messages/problem.h"
#include "server/fairway/worker/sandbox_trials.h"
#include "server/os/sandbox.h"

namespace fairway {
namespace {

constexpr SandboxLimits kLimits = {std::uint64_t{1} << 30U, 60, std::uint64_t{1} << 30U};
// Exit codes of a child.
constexpr int kSucceeded = 0;
constexpr int kRefused = 1;
constexpr int kNotConfined = 2;

/// The limits of a job are left out where sanitizers need terabytes.
SandboxLimits limits() {
  return Sandbox::has_filter() ? kLimits : SandboxLimits{};
}

[[noreturn]] void run_child(const SandboxTrial& trial, SelfTest how) {
  if (how == SelfTest::confined) {
    auto sandbox = Sandbox::prepare(limits());
    if (!sandbox || !sandbox->close()) _exit(kNotConfined);
  }
  _exit(trial.succeeds() ? kSucceeded : kRefused);
}

/// The wait status of a child that tried, or -1 where there is none.
int try_in_child(const SandboxTrial& trial, SelfTest how) {
  const pid_t child = ::fork();
  if (child == 0) run_child(trial, how);
  int status = -1;
  return child > 0 && ::waitpid(child, &status, 0) == child ? status : -1;
}

std::string describe(int status) {
  if (status == -1) return "no process could be started";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) return "forbidden system call";
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
  switch (WEXITSTATUS(status)) {
    case kSucceeded:
      return "succeeded";
    case kRefused:
      return "the process lives, and did not succeed";
    default:
      return "could not confine itself";
  }
}

/// Prints a line; whether all is as it has to be.
bool tell(std::string_view kind, const SandboxTrial& trial, int status, bool good) {
  fmt::print("{:<7}{:<10}{:<34}{}\n", good ? "ok" : "FAILED", kind, trial.name, describe(status));
  return good;
}

bool dies(const SandboxTrial& trial, SelfTest how) {
  const int status = try_in_child(trial, how);
  return tell("forbidden", trial, status, WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS);
}

bool lives(const SandboxTrial& trial, SelfTest how) {
  const int status = try_in_child(trial, how);
  return tell("allowed", trial, status, WIFEXITED(status) && WEXITSTATUS(status) == kSucceeded);
}

/// In a child, because it cannot be undone.
void tell_namespaces() {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto sandbox = Sandbox::prepare({});
    if (!sandbox) _exit(kNotConfined);
    const std::string& refusal = sandbox->namespace_refusal();
    fmt::print("{}\n", refusal.empty() ? "note   workers have a user and a network namespace of "
                                         "their own"
                                       : fmt::format("note   workers have no namespaces of their "
                                                     "own: {}",
                                                     refusal));
    std::fflush(stdout);
    _exit(kSucceeded);
  }
  if (child > 0) ::waitpid(child, nullptr, 0);
}

}  // namespace

int test_sandbox(SelfTest how) {
  bool good = true;
  tell_namespaces();
  if (Sandbox::has_filter() || how == SelfTest::unconfined) {
    for (const SandboxTrial& trial : forbidden_trials()) good = dies(trial, how) && good;
  } else {
    fmt::print(
        "note   this build has sanitizers, whose runtime no filter fits: nothing is "
        "forbidden\n");
  }
  for (const SandboxTrial& trial : allowed_trials()) good = lives(trial, how) && good;
  return good ? 0 : problem_kind(ErrorCode::internal).exit_code;
}

}  // namespace fairway
