#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "core/result.h"
#include "server/os/file.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// True for names that fairway-submit uses beside the results.
bool is_own_name(std::string_view name);

/// The folder of the results, held by one fairway-submit at a time.
class OutDirectory {
 public:
  /// Makes the folder where it is missing, locks it, and removes what an earlier run left half
  /// written. Errors: usage (it cannot be made, or another fairway-submit works in it).
  static Result<OutDirectory> open(const std::filesystem::path& path);

  std::filesystem::path journal() const;
  std::filesystem::path result(const std::string& name) const { return path_ / name; }
  bool has(const std::string& name) const;
  /// True where the file is there and has this digest.
  bool holds(const std::string& name, const std::string& sha256) const;
  /// A result under construction, with the permissions that a person's new file gets.
  /// Errors: io, storage_full.
  Result<AtomicFile> create_part() const;

 private:
  OutDirectory(std::filesystem::path path, UniqueFd lock, mode_t mode)
      : path_(std::move(path)), lock_(std::move(lock)), mode_(mode) {}

  std::filesystem::path path_;
  UniqueFd lock_;
  mode_t mode_;
};

}  // namespace fairway
