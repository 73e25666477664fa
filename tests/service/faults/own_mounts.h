#pragma once

#include <cstddef>
#include <filesystem>

#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// From here on this process and its children mount what nobody else sees. Needs root, or a kernel
/// that gives users namespaces of their own. False, said plainly: it is not allowed here.
bool enter_own_mounts();

/// An empty disk of so many bytes, gone with its object.
class SmallDisk {
 public:
  explicit SmallDisk(std::size_t bytes);
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk();

  const std::filesystem::path& path() const { return directory_.path(); }

 private:
  TemporaryDirectory directory_;
};

/// Nobody can write to a directory while it lives.
class ReadOnly {
 public:
  explicit ReadOnly(std::filesystem::path directory);
  ReadOnly(const ReadOnly&) = delete;
  ReadOnly& operator=(const ReadOnly&) = delete;
  ~ReadOnly();

 private:
  std::filesystem::path directory_;
};

}  // namespace fairway::test
