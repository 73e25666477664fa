#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// "Cannot <doing>: <what the system says>." for an errno value.
std::string system_sentence(std::string_view doing, int error_number);

/// The Error for a failed file operation: storage_full for a full disk or quota, otherwise io.
Error file_error(std::string_view doing, int error_number);

/// open() with O_CLOEXEC. Errors: io.
Result<UniqueFd> open_file(const std::filesystem::path& path, int flags, mode_t mode = 0600);

/// Opens a file that a document names, by its path below `folder`: every name on the way in the
/// directory before it, never through a symbolic link. Errors: io.
Result<UniqueFd> open_beneath(UniqueFd folder, const std::string& path);

/// Writes all of `bytes` at the descriptor's position. Errors: io, storage_full.
Result<void> write_all(int fd, std::span<const std::byte> bytes);

/// The same for the pieces of a whole, without joining them.
Result<void> write_all(int fd, std::span<const std::span<const std::byte>> pieces);

/// Makes a directory's entries durable (after a rename into it). Errors: io.
Result<void> sync_directory(const std::filesystem::path& directory);

/// Size of an open regular file in bytes. Errors: io.
Result<std::uint64_t> size_of(int fd);

/// Has the disk begin with what was written to a file, so that the fsync that follows has less to
/// wait for. Advice only: where it fails, that fsync tells.
void begin_sync(int fd);

/// A file under construction: a temporary name until commit() has made content and name durable
/// (fsync, rename, fsync of the directory). Destroyed before that, it leaves nothing behind.
class AtomicFile {
 public:
  /// Creates `temporary`, which must not exist, readable and writable by the owner only.
  /// Errors: io, storage_full.
  static Result<AtomicFile> create(std::filesystem::path temporary);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  int descriptor() const { return fd_.get(); }
  /// Gives the file its final name on the same file system. Errors: io, storage_full.
  Result<void> commit(const std::filesystem::path& final_path);
  /// The same without waiting for the disk: a crash of the machine, not one of the process, may
  /// lose it. Errors: io.
  Result<void> rename_to(const std::filesystem::path& final_path);

 private:
  AtomicFile(std::filesystem::path temporary, UniqueFd fd)
      : temporary_(std::move(temporary)), fd_(std::move(fd)) {}

  std::filesystem::path temporary_;  ///< empty once committed or moved from
  UniqueFd fd_;
};

}  // namespace fairway
