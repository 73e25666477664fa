#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "server/fairwayd/store/sqlite.h"
#include "server/fairwayd/store/tenant_store.h"

namespace fairway {

/// Tenants and their keys, in the file of the jobs, over a connection of its own.
class SqliteTenantStore final : public TenantStore {
 public:
  /// Opens or creates the file and brings its schema up to date. Errors: as SqliteJobStore::open().
  static Result<std::unique_ptr<SqliteTenantStore>> open(const std::filesystem::path& path);

  Result<std::string> add_key(const NewKey& key) override;
  Result<std::vector<ApiKey>> keys() override;
  Result<ApiKey> revoke_key(const std::string& id) override;
  Result<std::optional<ApiKey>> find_key(const KeyText& text) override;
  Result<std::vector<Tenant>> tenants() override;
  Result<void> set_tenant(const Tenant& tenant) override;

 private:
  explicit SqliteTenantStore(Database database) : database_(std::move(database)) {}

  std::mutex mutex_;
  Database database_;
};

}  // namespace fairway
