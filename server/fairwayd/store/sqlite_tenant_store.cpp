#include "server/fairwayd/store/sqlite_tenant_store.h"

#include <cmath>
#include <utility>

#include "server/fairwayd/store/job_id.h"
#include "server/fairwayd/store/job_schema.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

#define FAIRWAY_KEY_COLUMNS "id, tenant, scopes, label, created, expires, revoked"
constexpr std::string_view kAddTenant =
    "INSERT INTO tenant (name) VALUES (?) ON CONFLICT DO NOTHING";
constexpr std::string_view kAddKey =
    "INSERT INTO api_key (id, digest, tenant, scopes, label, created, expires) "
    "VALUES (?, ?, ?, ?, ?, ?, ?)";
constexpr std::string_view kKeys =
    "SELECT " FAIRWAY_KEY_COLUMNS " FROM api_key ORDER BY created, id";
constexpr std::string_view kRevoke =
    "UPDATE api_key SET revoked = coalesce(revoked, ?) WHERE id = ? "
    "RETURNING " FAIRWAY_KEY_COLUMNS;
constexpr std::string_view kFindKey =
    "SELECT " FAIRWAY_KEY_COLUMNS ", digest FROM api_key WHERE id = ?";
constexpr int kDigest = 7;  // the column behind those of the key
#undef FAIRWAY_KEY_COLUMNS
// A weight is read and written as a text: SQLite keeps its number.
constexpr std::string_view kTenants =
    "SELECT name, CAST(weight AS TEXT), most_running, most_queued, most_bytes FROM tenant "
    "ORDER BY name";
constexpr std::string_view kSetTenant =
    "INSERT INTO tenant (name, weight, most_running, most_queued, most_bytes) "
    "VALUES (?1, CAST(?2 AS REAL), ?3, ?4, ?5) ON CONFLICT (name) DO UPDATE SET "
    "weight = excluded.weight, most_running = excluded.most_running, "
    "most_queued = excluded.most_queued, most_bytes = excluded.most_bytes";

std::optional<std::int64_t> optional_integer(const Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.integer(column));
}

ApiKey key_of(const Query& row) {
  return {row.text(0), row.text(1),
          // A scope that a newer fairwayd wrote grants nothing here.
          [&] {
            const auto scopes = parse_scopes(row.text(2));
            return scopes ? *scopes : Scopes();
          }(),
          row.text(3), row.integer(4), optional_integer(row, 5), optional_integer(row, 6)};
}

Error bad_name() {
  return {ErrorCode::usage,
          "The name of a tenant has 1 to 64 letters, digits, hyphens or underscores."};
}

}  // namespace

Result<std::unique_ptr<SqliteTenantStore>> SqliteTenantStore::open(
    const std::filesystem::path& path) {
  auto database = Database::open(path);
  if (!database) return database.error();
  if (auto done = migrate_job_schema(*database); !done) return done.error();
  return std::unique_ptr<SqliteTenantStore>(new SqliteTenantStore(std::move(*database)));
}

Result<std::string> SqliteTenantStore::add_key(const NewKey& key) {
  if (!is_job_id(key.tenant)) return bad_name();
  const std::lock_guard lock(mutex_);
  const KeyText text = new_key_text();
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  {
    Query tenant = database_.query(kAddTenant);
    if (auto done = tenant.bind(key.tenant).step(); !done) return done.error();
    Query insert = database_.query(kAddKey);
    insert.bind(text.id).bind(digest_of(text)).bind(key.tenant).bind(to_string(key.scopes));
    insert.bind(key.label).bind(wall_clock()).bind(key.expires);
    if (auto done = insert.step(); !done) return done.error();
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return to_string(text);
}

Result<std::vector<ApiKey>> SqliteTenantStore::keys() {
  const std::lock_guard lock(mutex_);
  std::vector<ApiKey> keys;
  Query rows = database_.query(kKeys);
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return keys;
    keys.push_back(key_of(rows));
  }
}

Result<ApiKey> SqliteTenantStore::revoke_key(const std::string& id) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kRevoke);
  auto row = query.bind(wall_clock()).bind(id).step();
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::not_found, "There is no key with this id: see keys list."};
  ApiKey key = key_of(query);
  // The change is complete when the statement is.
  if (auto done = query.step(); !done) return done.error();
  return key;
}

Result<std::optional<ApiKey>> SqliteTenantStore::find_key(const KeyText& text) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kFindKey);
  auto row = query.bind(text.id).step();
  if (!row) return row.error();
  if (!*row || !same_digest(query.text(kDigest), digest_of(text))) return std::optional<ApiKey>();
  return std::optional(key_of(query));
}

Result<std::vector<Tenant>> SqliteTenantStore::tenants() {
  const std::lock_guard lock(mutex_);
  std::vector<Tenant> tenants;
  Query rows = database_.query(kTenants);
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return tenants;
    tenants.push_back({rows.text(0), std::stod(rows.text(1)), optional_integer(rows, 2),
                       optional_integer(rows, 3), optional_integer(rows, 4)});
  }
}

Result<void> SqliteTenantStore::set_tenant(const Tenant& tenant) {
  if (!is_job_id(tenant.name)) return bad_name();
  const auto is_positive = [](const std::optional<std::int64_t>& number) {
    return number.value_or(1) >= 1;
  };
  if (!std::isfinite(tenant.weight) || tenant.weight < 1e-3 || tenant.weight > 1e3 ||
      !is_positive(tenant.most_running) || !is_positive(tenant.most_queued) ||
      !is_positive(tenant.most_bytes)) {
    return Error{ErrorCode::usage,
                 "A weight lies between 0.001 and 1000, and every other limit is at least 1."};
  }
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kSetTenant);
  query.bind(tenant.name).bind(std::to_string(tenant.weight)).bind(tenant.most_running);
  if (auto done = query.bind(tenant.most_queued).bind(tenant.most_bytes).step(); !done) {
    return done.error();
  }
  return {};
}

}  // namespace fairway
