#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "server/fairway-submit/file_outcome.h"

namespace fairway {

/// What a person sees of a batch, on standard error: a line per file that ended, and on a terminal
/// a bar below them. Threads may share it.
class ProgressDisplay {
 public:
  enum class Style {
    quiet,     ///< failures only
    lines,     ///< every file
    terminal,  ///< failures, and a bar
  };

  ProgressDisplay(Style style, std::size_t files);

  void begun();
  /// `label`: what the file is called.
  void ended(std::string_view label, const FileOutcome& outcome);
  /// Said once until it is over.
  void server_missing(const std::string& why);
  void server_answers();
  /// A line of its own.
  void say(std::string_view text);

  /// Draws the bar anew; nothing where there is none. To be called a few times a second.
  void draw();
  /// Takes the bar away.
  void clear();

 private:
  void line(std::string_view text);

  const Style style_;
  const std::size_t files_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();

  std::mutex mutex_;  ///< guards what follows, and the terminal
  std::size_t running_ = 0;
  std::size_t ended_ = 0;
  std::size_t failed_ = 0;
  std::uint64_t bytes_ = 0;
  std::string missing_;  ///< why the server is missing; empty: it is not
  bool drawn_ = false;
};

}  // namespace fairway
