#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace fairway {

/// A few threads that share loops. Made once per run; for_ranges() is called from one thread.
class ThreadTeam {
 public:
  /// `threads` − 1 helpers beside the caller.
  explicit ThreadTeam(unsigned threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Calls body(first, last) for ranges of at most `grain` that cover 0 … count, each once, on any
  /// thread and in any order; returns when all are done. The ranges do not depend on the number of
  /// threads.
  void for_ranges(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

 private:
  struct Loop {
    std::size_t count = 0;
    std::size_t grain = 1;
    const std::function<void(std::size_t, std::size_t)>* body = nullptr;
  };
  void help();
  bool take_range(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  Loop loop_;
  std::size_t next_ = 0;     // first item nobody has taken
  std::size_t working_ = 0;  // ranges being worked on
  bool ending_ = false;
  std::vector<std::jthread> helpers_;
};

}  // namespace fairway
