#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A stored payload.
struct BlobInfo {
  std::string key;
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 lower-case hexadecimal digits
};

/// A payload under construction in local spool space. Dropped without commit(), it never existed.
class BlobDraft {
 public:
  virtual ~BlobDraft() = default;

  /// A writable regular file, at its end; valid while the draft lives. A worker process may write
  /// to it directly, instead of append().
  virtual int descriptor() const = 0;

  /// Errors: storage_full, io.
  virtual Result<void> append(std::span<const std::byte> bytes) = 0;

  /// Makes the payload durable under `key` (an existing one is replaced) and says what it is.
  /// Once. Errors: storage_full, io.
  virtual Result<BlobInfo> commit(std::string_view key) = 0;
};

/// Where payloads live. Keys are made by the server ("in-<random>",
/// "out-<job number>-<fence>-<job id>"). All operations may be called from any thread.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  /// Errors: storage_full, io, unavailable.
  virtual Result<std::unique_ptr<BlobDraft>> create() = 0;

  /// Makes a durable payload under `key` of a file of this machine, which stays and must not change
  /// any more; not copied where that can be helped. Errors: storage_full, io, unavailable.
  virtual Result<BlobInfo> adopt(const std::filesystem::path& file, std::string_view key) = 0;

  /// A readable regular file at its start (a remote store hands out a local copy). It stays
  /// readable when the blob is removed. Errors: gone (no such blob), io.
  virtual Result<UniqueFd> open(std::string_view key) = 0;

  /// Removes a blob; one that does not exist is no error. Errors: io.
  virtual Result<void> remove(std::string_view key) = 0;

  /// How many bytes may still be stored. Errors: io.
  virtual Result<std::uint64_t> free_bytes() = 0;

  /// Removes every blob that is not in `needed`, and what drafts of a dead server left behind. Only
  /// at the start, before any draft exists. Returns how many files. Errors: io.
  virtual Result<std::size_t> sweep(const std::vector<std::string>& needed) = 0;
};

}  // namespace fairway
