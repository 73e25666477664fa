#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "tests/service/support/temporary_directory.h"

namespace fairway::hostile {

/// A program that stands in for the worker: the worker itself, under strace.
class AccessTrace {
 public:
  /// False where this machine has no strace, or does not let it trace.
  static bool is_possible();

  AccessTrace();

  /// For --worker.
  std::string program() const { return (directory_.path() / "traced-worker").string(); }
  /// Files and networks that workers reached for since the last call, each as "call path".
  std::set<std::string> new_accesses();

 private:
  const test::TemporaryDirectory directory_;
  std::map<std::filesystem::path, std::size_t> read_;  ///< bytes of each trace
};

}  // namespace fairway::hostile
