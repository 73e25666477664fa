#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::hostile {

/// A real service under attack, with its log and its data.
class Target {
 public:
  explicit Target(const std::vector<std::string>& options = {});
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  ~Target();

  test::HttpClient client() const { return service_.client(); }
  std::uint16_t port() const { return service_.port(); }
  std::vector<pid_t> workers() const { return service_.workers(); }

  /// The process that was started lives.
  bool is_alive() const;
  /// KiB in memory of the service and all processes below it.
  long resident() const;
  /// Most KiB in memory of the service itself, ever.
  long peak() const;
  /// Lines of the log since the last call.
  std::string new_log();
  /// What is wrong with the log's new lines, or with names in the data directory: a line that is no
  /// JSON object, a control character, a name that is not the service's own. Empty: nothing.
  std::string traces_of_input();

 private:
  const test::TemporaryDirectory directory_;
  const std::filesystem::path log_;
  test::ServiceProcess service_;
  std::size_t log_read_ = 0;
};

/// Asks /livez over and over, each time in a connection of its own, and watches whether this
/// machine itself stands still.
class LivenessProbe {
 public:
  /// `pause`: between two questions.
  LivenessProbe(std::uint16_t port, std::chrono::milliseconds pause);

  /// Forgets what was measured.
  void restart();
  /// Milliseconds until each answer of 200; 1e9 where another answer or none came.
  std::vector<double> times() const;
  /// The longest of times(), or since the question that is open now.
  double longest() const;
  /// Longest time that this program did not run although it wanted to.
  double longest_stall() const;

 private:
  void ask(const std::stop_token& stop);
  void watch_clock(const std::stop_token& stop);

  const std::uint16_t port_;
  const std::chrono::milliseconds pause_;
  mutable std::mutex mutex_;
  std::vector<double> times_;                    ///< guarded by mutex_
  std::chrono::steady_clock::time_point asked_;  ///< guarded by mutex_
  bool open_ = false;                            ///< guarded by mutex_
  double stall_ = 0.0;                           ///< guarded by mutex_
  std::jthread clock_;
  std::jthread asker_;
};

/// The value that this share of them does not exceed.
double quantile(std::vector<double> values, double share);

}  // namespace fairway::hostile
