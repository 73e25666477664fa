// The one file that knows SQLite's C interface.
#include "server/fairwayd/store/sqlite.h"

#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

namespace fairway {
namespace {

Error sqlite_error(int status, sqlite3* database) {
  const char* text = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(status);
  const std::string message = fmt::format("The job database refused: {}.", text);
  switch (status & 0xff) {
    case SQLITE_FULL:
      return {ErrorCode::storage_full, message};
    case SQLITE_CONSTRAINT:
      return {ErrorCode::conflict, message};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_NOMEM:
    case SQLITE_READONLY:
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {ErrorCode::unavailable, message};
    default:
      return {ErrorCode::internal, message};
  }
}

}  // namespace

Query::Query(sqlite3* database, sqlite3_stmt* statement, int status)
    : database_(database), statement_(statement), status_(status) {}

Query::Query(Query&& other) noexcept
    : database_(other.database_),
      statement_(std::exchange(other.statement_, nullptr)),
      status_(other.status_),
      bound_(other.bound_) {}

Query::~Query() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

Query& Query::bind(std::int64_t value) {
  if (status_ == SQLITE_OK) status_ = sqlite3_bind_int64(statement_, ++bound_, value);
  return *this;
}

Query& Query::bind(std::string_view text) {
  if (status_ == SQLITE_OK) {
    status_ = sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(), SQLITE_TRANSIENT,
                                  SQLITE_UTF8);
  }
  return *this;
}

Query& Query::bind(const std::optional<std::int64_t>& value) {
  return value ? bind(*value) : bind_null();
}

Query& Query::bind_null() {
  if (status_ == SQLITE_OK) status_ = sqlite3_bind_null(statement_, ++bound_);
  return *this;
}

Result<bool> Query::step() {
  if (status_ != SQLITE_OK) return sqlite_error(status_, database_);
  const int status = sqlite3_step(statement_);
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  return sqlite_error(status, database_);
}

bool Query::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::int64_t Query::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

std::string Query::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  if (text == nullptr) return {};
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

Result<Database> Database::open(const std::filesystem::path& path) {
  sqlite3* raw = nullptr;
  const int status =
      sqlite3_open_v2(path.c_str(), &raw,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database;
  database.handle_.reset(raw);
  if (status != SQLITE_OK) return sqlite_error(status, raw);
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, 5000);
  auto configured = database.execute(
      "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA foreign_keys=ON;"
      "PRAGMA trusted_schema=OFF;");
  if (!configured) return configured.error();
  return database;
}

Result<void> Database::check_file() const {
  int moved = 0;
  const int status = sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  if (status == SQLITE_OK && moved == 0) return {};
  return Error{ErrorCode::unavailable, "The file of the job database is gone, or is another one."};
}

Result<void> Database::execute(const std::string& script) {
  const int status = sqlite3_exec(handle_.get(), script.c_str(), nullptr, nullptr, nullptr);
  if (status != SQLITE_OK) return sqlite_error(status, handle_.get());
  return {};
}

Query Database::query(std::string_view sql) {
  auto found = statements_.find(sql);
  if (found == statements_.end()) {
    sqlite3_stmt* raw = nullptr;
    const int status = sqlite3_prepare_v3(handle_.get(), sql.data(), static_cast<int>(sql.size()),
                                          SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
    if (status != SQLITE_OK) return Query(handle_.get(), nullptr, status);
    found = statements_.emplace(sql, raw).first;
  }
  return Query(handle_.get(), found->second.get(), SQLITE_OK);
}

std::int64_t Database::changes() const {
  return sqlite3_changes64(handle_.get());
}

void Database::CloseDatabase::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

void Database::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Result<Transaction> Transaction::begin(Database& database) {
  if (auto begun = database.execute("BEGIN IMMEDIATE"); !begun) return begun.error();
  Transaction transaction(database);
  if (auto there = database.check_file(); !there) return there.error();
  return transaction;
}

Transaction::~Transaction() {
  if (database_ == nullptr) return;
  // Some errors roll back by themselves; then this one is refused, which is what is wanted.
  [[maybe_unused]] const auto rolled_back = database_->execute("ROLLBACK");
}

Result<void> Transaction::commit() {
  if (auto done = database_->execute("COMMIT"); !done) return done;
  database_ = nullptr;
  return {};
}

}  // namespace fairway
