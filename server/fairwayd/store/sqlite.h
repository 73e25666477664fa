#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace fairway {

/// One use of a prepared statement: bind in order, step, read columns. A failure to prepare or bind
/// is reported by the next step(). Resets the statement when it goes. Not for use across threads.
class Query {
 public:
  Query(sqlite3* database, sqlite3_stmt* statement, int status);
  Query(Query&& other) noexcept;
  Query& operator=(Query&&) = delete;
  ~Query();

  Query& bind(std::int64_t value);
  Query& bind(std::string_view text);
  Query& bind(const std::optional<std::int64_t>& value);
  Query& bind_null();

  /// True: there is a row. False: done. Errors: storage_full, unavailable, conflict (a constraint
  /// says no), internal.
  Result<bool> step();

  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  std::string text(int column) const;

 private:
  sqlite3* database_;
  sqlite3_stmt* statement_;  ///< owned by the Database
  int status_;
  int bound_ = 0;
};

/// A connection to an SQLite file. Not for use by two threads at once.
class Database {
 public:
  /// Opens or creates the file: WAL, synchronous=FULL, foreign keys, 5 s busy timeout.
  /// Errors: as Query::step().
  static Result<Database> open(const std::filesystem::path& path);

  /// Whether the file still has the name it was opened by: what is written to one that has not is
  /// lost when it is closed. Errors: unavailable.
  Result<void> check_file() const;

  /// Runs statements without parameters or rows.
  Result<void> execute(const std::string& script);

  /// Prepares a statement, once for every text. `sql` must be a literal.
  Query query(std::string_view sql);

  /// Rows changed by the last statement.
  std::int64_t changes() const;

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };

  std::unique_ptr<sqlite3, CloseDatabase> handle_;
  std::map<std::string_view, std::unique_ptr<sqlite3_stmt, Finalize>> statements_;
};

/// BEGIN IMMEDIATE … COMMIT, or ROLLBACK where commit() was not reached.
class Transaction {
 public:
  /// Errors: as Query::step(), Database::check_file().
  static Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  Result<void> commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  ///< null once over
};

}  // namespace fairway
