#pragma once

#include <filesystem>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// The directory of one running fairwayd. Holds a lock on DIR/lock while it lives; one object of a
/// directory per process, because the lock is the process's.
class DataDirectory {
 public:
  /// Creates the directory where it is absent. Errors: conflict (another fairwayd uses it), io.
  static Result<DataDirectory> open(const std::filesystem::path& path);

  std::filesystem::path jobs() const { return path_ / "jobs.sqlite"; }
  std::filesystem::path blobs() const { return path_ / "blobs"; }
  std::filesystem::path spool() const { return path_ / "spool"; }
  std::filesystem::path uploads() const { return path_ / "uploads"; }

 private:
  DataDirectory(std::filesystem::path path, UniqueFd lock)
      : path_(std::move(path)), lock_(std::move(lock)) {}

  std::filesystem::path path_;
  UniqueFd lock_;
};

}  // namespace fairway
