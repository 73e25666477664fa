#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/messages/job_document.h"
#include "server/fairwayd/store/access.h"

namespace fairway {

/// A key as it is kept: without its secret.
struct ApiKey {
  std::string id;
  std::string tenant;
  Scopes scopes;
  std::string label;  ///< what a person calls it
  UnixMillis created = 0;
  std::optional<UnixMillis> expires;
  std::optional<UnixMillis> revoked;
};

/// What is said of a key when it is made.
struct NewKey {
  std::string tenant;
  Scopes scopes;
  std::string label;
  std::optional<UnixMillis> expires;
};

/// Somebody whose jobs are his own, and his share of the service.
struct Tenant {
  std::string name;                          ///< see is_job_id()
  double weight = 1;                         ///< turns of the workers, beside others; above 0
  std::optional<std::int64_t> most_running;  ///< jobs at a time
  std::optional<std::int64_t> most_queued;   ///< jobs that wait
  std::optional<std::int64_t> most_bytes;    ///< of meshes kept; nothing: as the service says
};

/// Who may use the service. All operations are durable when they return, and seen at once by a
/// service that runs on the same store. Errors of all: unavailable, storage_full, internal.
class TenantStore {
 public:
  virtual ~TenantStore() = default;

  /// Makes a key, and its tenant where there is none of the name. Returns its text, which nobody
  /// can find out again. Errors: usage (the name).
  virtual Result<std::string> add_key(const NewKey& key) = 0;

  /// Oldest first, those revoked too.
  virtual Result<std::vector<ApiKey>> keys() = 0;

  /// From now on it opens nothing; a key that was revoked before stays as it is.
  /// Errors: not_found.
  virtual Result<ApiKey> revoke_key(const std::string& id) = 0;

  /// The key of this text, whether or not it is still good; nothing where there is none.
  virtual Result<std::optional<ApiKey>> find_key(const KeyText& text) = 0;

  /// By name.
  virtual Result<std::vector<Tenant>> tenants() = 0;

  /// Writes a tenant's share; makes the tenant where there is none of the name. Errors: usage (the
  /// name, or a number that makes no sense).
  virtual Result<void> set_tenant(const Tenant& tenant) = 0;
};

}  // namespace fairway
