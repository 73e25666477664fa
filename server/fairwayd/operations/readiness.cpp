#include "server/fairwayd/operations/readiness.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>

#include "server/fairwayd/operations/canary.h"
#include "server/fairwayd/operations/sandbox_check.h"
#include "server/os/child_process.h"
#include "server/os/file.h"

namespace fairway {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kStartWithin = 10s;
constexpr std::chrono::seconds kCanaryWithin = 30s;
constexpr std::chrono::seconds kBadHolds = 5s;

/// The canary is small: it needs no more time than this, whatever a job may take.
ReadinessOptions with_short_canary(ReadinessOptions options) {
  options.limits.deadline = std::min(options.limits.deadline, kCanaryWithin);
  options.limits.cpu = std::min(options.limits.cpu, kCanaryWithin);
  return options;
}

}  // namespace

Readiness::Readiness(JobStore& jobs, BlobStore& blobs, WorkerPool& workers, const Log& log,
                     ReadinessOptions options, std::stop_token stop)
    : jobs_(jobs),
      blobs_(blobs),
      workers_(workers),
      log_(log),
      options_(with_short_canary(std::move(options))),
      stop_(std::move(stop)),
      store_{"store", "Jobs cannot be stored.", 1s, [this] { return jobs_.probe(); }, {}, {}, {}},
      data_{"data", "Meshes cannot be stored.", 1s, [this] { return write_file(); }, {}, {}, {}},
      disk_{"disk", "Less disk space is left than is kept free (--min-free).",
            0s,     [this] { return check_disk(); },
            {},     {},
            {}},
      worker_{"worker", "The worker program does not start.",
              5s,       [this] { return start_worker(); },
              {},       {},
              {}},
      sandbox_{"sandbox", "The sandbox of the workers does not hold.",
               60s,       [this] { return test_sandbox(); },
               {},        {},
               {}},
      canary_{"canary", "A worker did not denoise the mesh that it was tried with.",
              5s,       [this] { return run_canary(blobs_, workers_, options_.limits, stop_); },
              {},       {},
              {}} {}

std::vector<ReadinessCheck> Readiness::check(bool with_canary) {
  std::vector<ReadinessCheck> checks;
  for (Probe* probe : {&store_, &data_, &disk_, &worker_, &sandbox_}) checks.push_back(ask(*probe));
  if (with_canary) checks.push_back(ask(canary_));
  return checks;
}

/// Only changes are logged: probes come every few seconds.
ReadinessCheck Readiness::ask(Probe& probe) {
  const std::lock_guard lock(probe.mutex);
  const bool was_ok = probe.ok.value_or(true);
  const auto holds = was_ok ? probe.holds : std::min(probe.holds, kBadHolds);
  if (!probe.ok || Clock::now() - probe.looked >= holds) {
    const Result<void> found = probe.look();
    const bool ok = static_cast<bool>(found);
    if (!ok && was_ok) {
      log_.write(LogLevel::error, "not_ready",
                 {{"check", probe.name}, {"reason", found.error().message}});
    } else if (ok && !was_ok) {
      log_.write(LogLevel::info, "ready_again", {{"check", probe.name}});
    }
    probe.ok = ok;
    probe.looked = Clock::now();
  }
  return {probe.name, *probe.ok, *probe.ok ? std::string() : std::string(probe.complaint)};
}

Result<void> Readiness::write_file() {
  auto draft = blobs_.create();
  if (!draft) return draft.error();
  constexpr std::array<std::byte, 1> kSomething{};
  return (*draft)->append(kSomething);
}

Result<void> Readiness::check_disk() {
  const auto left = blobs_.free_bytes();
  if (!left) return left.error();
  if (*left >= options_.min_free) return {};
  return Error{ErrorCode::storage_full,
               fmt::format("{} bytes are left, {} are to be.", *left, options_.min_free)};
}

Result<void> Readiness::start_worker() const {
  const auto null = open_file("/dev/null", O_RDWR);
  if (!null) return null.error();
  auto process = ChildProcess::spawn(
      {options_.worker, {"--version"}, {}, {null->get(), null->get(), null->get()}});
  if (!process) return process.error();
  pollfd ended{process->descriptor(), POLLIN, 0};
  if (::poll(&ended, 1, static_cast<int>(kStartWithin.count())) != 1) {
    return Error{ErrorCode::unavailable, "The worker program does not end."};
  }
  const ExitStatus status = process->wait();
  if (status.signal == 0 && status.code == 0) return {};
  return Error{ErrorCode::unavailable, fmt::format("The worker program ended with {}, signal {}.",
                                                   status.code, status.signal)};
}

/// What it notes (which namespaces there are) is logged once.
Result<void> Readiness::test_sandbox() {
  const auto test = run_self_test(options_.worker, stop_);
  if (!test) return test.error();
  if (test->note != sandbox_note_) {
    sandbox_note_ = test->note;
    log_.write(LogLevel::info, "sandbox", {{"note", test->note}});
  }
  if (test->passed) return {};
  return Error{ErrorCode::unavailable, test->failures};
}

}  // namespace fairway
