#include "server/fairwayd/store/sqlite_upload_store.h"

#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/store/job_schema.h"
#include "server/fairwayd/store/tenant_quota.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

#define FAIRWAY_UPLOAD_COLUMNS "tenant, id, length, metadata, expires, sha256, format"
constexpr std::string_view kAddTenant =
    "INSERT INTO tenant (name) VALUES (?) ON CONFLICT DO NOTHING";
constexpr std::string_view kCountOpen =
    "SELECT count(*) FROM upload WHERE tenant = ? AND sha256 IS NULL";
constexpr std::string_view kInsert =
    "INSERT INTO upload (tenant, id, length, metadata, keep, expires) "
    "VALUES (?1, ?2, ?3, ?4, ?5, ?6) RETURNING " FAIRWAY_UPLOAD_COLUMNS;
constexpr std::string_view kFind =
    "SELECT " FAIRWAY_UPLOAD_COLUMNS " FROM upload WHERE tenant = ? AND id = ?";
constexpr std::string_view kExtend =
    "UPDATE upload SET expires = ? + keep WHERE tenant = ? AND id = ? "
    "RETURNING " FAIRWAY_UPLOAD_COLUMNS;
#undef FAIRWAY_UPLOAD_COLUMNS
constexpr std::string_view kRemove = "DELETE FROM upload WHERE tenant = ? AND id = ?";
constexpr std::string_view kDue =
    "SELECT tenant, id FROM upload WHERE expires <= ? ORDER BY expires LIMIT ?";
constexpr std::string_view kExpire =
    "DELETE FROM upload WHERE tenant = ? AND id = ? AND expires <= ?";
constexpr std::string_view kOpen = "SELECT tenant, id FROM upload WHERE sha256 IS NULL";

Error unknown() {
  return {ErrorCode::not_found, "There is no upload with this id: create one."};
}

ResumableUpload upload_of(const Query& row) {
  ResumableUpload upload;
  upload.name = {row.text(0), row.text(1)};
  upload.length = static_cast<std::uint64_t>(row.integer(2));
  upload.metadata = row.text(3);
  upload.expires = row.integer(4);
  if (!row.is_null(5)) {
    upload.used = UsedUpload{row.text(5), format_of_name(row.text(6)).value_or(Format::glb)};
  }
  return upload;
}

/// The one row of a statement that changes something.
Result<ResumableUpload> changed(Query query) {
  auto row = query.step();
  if (!row) return row.error();
  if (!*row) return unknown();
  ResumableUpload upload = upload_of(query);
  // The change is complete when the statement is.
  if (auto done = query.step(); !done) return done.error();
  return upload;
}

Result<std::vector<UploadName>> read_names(Query rows) {
  std::vector<UploadName> names;
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return names;
    names.push_back({rows.text(0), rows.text(1)});
  }
}

}  // namespace

Result<std::unique_ptr<SqliteUploadStore>> SqliteUploadStore::open(
    const std::filesystem::path& path) {
  auto database = Database::open(path);
  if (!database) return database.error();
  if (auto done = migrate_job_schema(*database); !done) return done.error();
  return std::unique_ptr<SqliteUploadStore>(new SqliteUploadStore(std::move(*database)));
}

Result<ResumableUpload> SqliteUploadStore::create(const NewUpload& upload,
                                                  const UploadLimits& limits) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  const std::string& tenant = upload.name.tenant;
  if (auto room = check_open(tenant, limits.most_open); !room) return room.error();
  if (auto room = check_tenant_quota(database_, tenant, upload.length, limits.tenant_bytes);
      !room) {
    return room.error();
  }
  {
    Query add = database_.query(kAddTenant);
    if (auto done = add.bind(tenant).step(); !done) return done.error();
  }
  Query insert = database_.query(kInsert);
  insert.bind(tenant).bind(upload.name.id).bind(static_cast<std::int64_t>(upload.length));
  insert.bind(upload.metadata).bind(std::int64_t{upload.keep.count()});
  insert.bind(wall_clock() + upload.keep.count());
  auto created = changed(std::move(insert));
  if (!created) return created;
  if (auto done = transaction->commit(); !done) return done.error();
  return created;
}

Result<void> SqliteUploadStore::check_open(const std::string& tenant, std::size_t most) {
  Query query = database_.query(kCountOpen);
  if (auto row = query.bind(tenant).step(); !row) return row.error();
  if (static_cast<std::size_t>(query.integer(0)) < most) return {};
  return Error{
      ErrorCode::rate_limited,
      fmt::format("{} uploads are open, which is all that a tenant may have: finish some, delete "
                  "them, or wait until they expire.",
                  query.integer(0))};
}

Result<ResumableUpload> SqliteUploadStore::find(const UploadName& name) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kFind);
  auto row = query.bind(name.tenant).bind(name.id).step();
  if (!row) return row.error();
  if (!*row) return unknown();
  ResumableUpload upload = upload_of(query);
  if (upload.expires > wall_clock()) return upload;
  return Error{ErrorCode::gone, "The upload has expired: create a new one."};
}

Result<ResumableUpload> SqliteUploadStore::extend(const UploadName& name) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kExtend);
  query.bind(wall_clock()).bind(name.tenant).bind(name.id);
  return changed(std::move(query));
}

Result<void> SqliteUploadStore::remove(const UploadName& name) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kRemove);
  if (auto done = query.bind(name.tenant).bind(name.id).step(); !done) return done.error();
  return database_.changes() == 0 ? Result<void>(unknown()) : Result<void>();
}

Result<std::vector<UploadName>> SqliteUploadStore::due(UnixMillis now, std::size_t limit) {
  const std::lock_guard lock(mutex_);
  return read_names(
      std::move(database_.query(kDue).bind(now).bind(static_cast<std::int64_t>(limit))));
}

Result<bool> SqliteUploadStore::expire(const UploadName& name, UnixMillis now) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kExpire);
  if (auto done = query.bind(name.tenant).bind(name.id).bind(now).step(); !done) {
    return done.error();
  }
  return database_.changes() > 0;
}

Result<std::vector<UploadName>> SqliteUploadStore::open_uploads() {
  const std::lock_guard lock(mutex_);
  return read_names(database_.query(kOpen));
}

}  // namespace fairway
