// Ranges of a loop handed out to a few threads.

#include "core/thread_team.h"

#include <algorithm>

namespace fairway {

ThreadTeam::ThreadTeam(unsigned threads) {
  for (unsigned i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

ThreadTeam::~ThreadTeam() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
}

/// Works on one range, if there is one. The lock is open while the body runs.
bool ThreadTeam::take_range(std::unique_lock<std::mutex>& lock) {
  if (next_ >= loop_.count) return false;
  const std::size_t first = next_;
  const std::size_t last = std::min(first + loop_.grain, loop_.count);
  next_ = last;
  ++working_;
  const auto* body = loop_.body;
  lock.unlock();
  (*body)(first, last);
  lock.lock();
  if (--working_ == 0 && next_ >= loop_.count) changed_.notify_all();
  return true;
}

void ThreadTeam::help() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (!take_range(lock)) changed_.wait(lock, [this] { return ending_ || next_ < loop_.count; });
  }
}

void ThreadTeam::for_ranges(std::size_t count, std::size_t grain,
                            const std::function<void(std::size_t, std::size_t)>& body) {
  if (helpers_.empty()) {
    for (std::size_t first = 0; first < count; first += grain) {
      body(first, std::min(first + grain, count));
    }
    return;
  }
  std::unique_lock lock(mutex_);
  loop_ = {count, grain, &body};
  next_ = 0;
  changed_.notify_all();
  while (take_range(lock)) {
  }
  changed_.wait(lock, [this] { return working_ == 0; });
}

}  // namespace fairway
