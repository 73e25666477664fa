#include "server/fairwayd/work/sweeper.h"

#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

/// Jobs per round of the store, so that nobody waits long for it.
constexpr std::size_t kBatch = 100;

}  // namespace

Sweeper::Sweeper(JobStore& jobs, BlobStore& blobs, ResumableUploads& uploads, JobBoard& board,
                 const Log& log, const Options& options)
    : jobs_(jobs), blobs_(blobs), uploads_(uploads), board_(board), log_(log), options_(options) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void Sweeper::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    sweep();
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, stop, options_.every, [] { return false; });
  }
}

void Sweeper::sweep() {
  if (const auto uploads = uploads_.sweep(wall_clock()); !uploads) {
    log_.write(LogLevel::error, "sweep_failed", {{"reason", uploads.error().message}});
  } else if (*uploads > 0) {
    log_.write(LogLevel::info, "swept", {{"uploads", *uploads}});
  }
  std::size_t expired = 0;
  while (true) {
    const auto some = expire_due();
    if (!some) {
      log_.write(LogLevel::error, "sweep_failed", {{"reason", some.error().message}});
      return;
    }
    expired += *some;
    if (*some < kBatch) break;
  }
  const auto forgotten = jobs_.forget(wall_clock() - options_.forget.count());
  if (!forgotten) {
    log_.write(LogLevel::error, "sweep_failed", {{"reason", forgotten.error().message}});
  } else if (expired + *forgotten > 0) {
    log_.write(LogLevel::info, "swept", {{"expired", expired}, {"forgotten", *forgotten}});
    board_.announce();
  }
}

/// Returns how many there were.
Result<std::size_t> Sweeper::expire_due() {
  const auto due = jobs_.due(wall_clock(), kBatch);
  if (!due) return due.error();
  for (const JobName& name : *due) {
    const auto expiry = jobs_.expire(name);
    // Deleted or done again in between: then it is not due.
    if (!expiry && expiry.error().code != ErrorCode::not_found &&
        expiry.error().code != ErrorCode::conflict) {
      return expiry.error();
    }
    if (!expiry) continue;
    for (const std::string& key : expiry->blobs) {
      if (auto removed = blobs_.remove(key); !removed) {
        log_.write(LogLevel::warning, "blob_not_removed",
                   {{"key", key}, {"reason", removed.error().message}});
      }
    }
  }
  return due->size();
}

}  // namespace fairway
