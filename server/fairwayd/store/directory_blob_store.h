#pragma once

#include <filesystem>

#include "server/fairwayd/store/blob_store.h"

namespace fairway {

/// Blobs as files of one directory; drafts in a second one of the same file system.
class DirectoryBlobStore final : public BlobStore {
 public:
  /// Creates both directories where they are absent. Errors: io, storage_full.
  static Result<std::unique_ptr<DirectoryBlobStore>> open(const std::filesystem::path& blobs,
                                                          const std::filesystem::path& spool);

  Result<std::unique_ptr<BlobDraft>> create() override;
  Result<BlobInfo> adopt(const std::filesystem::path& file, std::string_view key) override;
  Result<UniqueFd> open(std::string_view key) override;
  Result<void> remove(std::string_view key) override;
  Result<std::uint64_t> free_bytes() override;
  Result<std::size_t> sweep(const std::vector<std::string>& needed) override;

 private:
  DirectoryBlobStore(std::filesystem::path blobs, std::filesystem::path spool)
      : blobs_(std::move(blobs)), spool_(std::move(spool)) {}

  Result<BlobInfo> copy_of(int file, std::string_view key);

  const std::filesystem::path blobs_;
  const std::filesystem::path spool_;
};

}  // namespace fairway
