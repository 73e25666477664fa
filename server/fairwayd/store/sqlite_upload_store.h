#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "server/fairwayd/store/sqlite.h"
#include "server/fairwayd/store/upload_store.h"

namespace fairway {

/// Uploads in the database of the jobs, over a connection of its own.
class SqliteUploadStore final : public UploadStore {
 public:
  /// Errors: as SqliteJobStore::open().
  static Result<std::unique_ptr<SqliteUploadStore>> open(const std::filesystem::path& path);

  Result<ResumableUpload> create(const NewUpload& upload, const UploadLimits& limits) override;
  Result<ResumableUpload> find(const UploadName& name) override;
  Result<ResumableUpload> extend(const UploadName& name) override;
  Result<void> remove(const UploadName& name) override;
  Result<std::vector<UploadName>> due(UnixMillis now, std::size_t limit) override;
  Result<bool> expire(const UploadName& name, UnixMillis now) override;
  Result<std::vector<UploadName>> open_uploads() override;

 private:
  explicit SqliteUploadStore(Database database) : database_(std::move(database)) {}

  Result<void> check_open(const std::string& tenant, std::size_t most);

  std::mutex mutex_;
  Database database_;
};

}  // namespace fairway
