// The file of jobs: what it refuses, and what older and newer programs wrote.
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/fairwayd/store/sqlite.h"
#include "tests/service/support/job_store_fixture.h"

using namespace fairway;
using namespace fairway::test;
using namespace std::chrono_literals;

TEST_CASE("a probe writes, as often as it is asked to, and fails where nothing can be written") {
  JobStoreFixture f;
  CHECK(f.store().probe());
  CHECK(f.store().probe());
  auto other = Database::open(f.path());
  REQUIRE(other);
  const auto lock = Transaction::begin(*other);
  REQUIRE(lock);
  CHECK(refusal(f.store().probe()) == ErrorCode::unavailable);
}

TEST_CASE("jobs of the first fairwayd are still done, and its results are still there") {
  TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  const std::string queued = random_id();
  const std::string done = random_id();
  {
    auto database = Database::open(path);
    REQUIRE(database);
    // Its columns and what it kept in them; its checks are no matter here.
    REQUIRE(database->execute(R"(
      CREATE TABLE job (seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE,
        state TEXT NOT NULL, revision INTEGER NOT NULL, attempt INTEGER NOT NULL,
        fence INTEGER NOT NULL, lease_owner TEXT, lease_until INTEGER, created INTEGER NOT NULL,
        started INTEGER, finished INTEGER, input_key TEXT NOT NULL, input_bytes INTEGER NOT NULL,
        input_sha256 TEXT NOT NULL, input_format TEXT NOT NULL, parameters TEXT NOT NULL,
        problem TEXT, report TEXT, result_key TEXT, result_bytes INTEGER, result_sha256 TEXT,
        result_format TEXT) STRICT;
      CREATE INDEX job_by_state ON job (state, seq);
      PRAGMA user_version = 1;)"));
    REQUIRE(
        database->execute("INSERT INTO job (id, state, revision, attempt, fence, created, "
                          "input_key, input_bytes, input_sha256, input_format, parameters) "
                          "VALUES ('" +
                          queued +
                          "', 'queued', 1, 1, 0, 5, 'in', 7, 'aa', "
                          "'glb', '{}')"));
    REQUIRE(database->execute(
        "INSERT INTO job (id, state, revision, attempt, fence, created, started, finished, "
        "input_key, input_bytes, input_sha256, input_format, parameters, report, result_key, "
        "result_bytes, result_sha256, result_format) VALUES ('" +
        done +
        "', 'succeeded', 3, 1, 1, "
        "5, 6, 8, 'in2', 7, 'aa', 'glb', '{}', '{}', 'out', 9, 'bb', 'ply')"));
  }
  auto store = SqliteJobStore::open(path);
  REQUIRE(store);
  const auto claimed = (*store)->claim("host", 60s);
  REQUIRE(claimed);
  REQUIRE(*claimed);
  CHECK((*claimed)->job.id == queued);
  CHECK((*claimed)->job.input.bytes == 7);
  CHECK((*claimed)->job.input_files == 1);
  const auto old = (*store)->find(JobName{.id = done});
  REQUIRE(old);
  REQUIRE(old->result);
  CHECK(old->result->key == "out");
  CHECK(old->result_format == Format::ply);
  CHECK(old->expires == 8 + 86'400'000);
}

TEST_CASE("a database of a newer fairwayd is refused") {
  TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  {
    auto database = Database::open(path);
    REQUIRE(database);
    REQUIRE(database->execute("PRAGMA user_version = 99"));
  }
  CHECK(refusal(SqliteJobStore::open(path)) == ErrorCode::conflict);
}

TEST_CASE("the database itself refuses a state that cannot be") {
  TemporaryDirectory directory;
  const auto path = directory.path() / "jobs.sqlite";
  auto store = SqliteJobStore::open(path);
  REQUIRE(store);
  const std::string id = random_id();
  REQUIRE((*store)->submit(new_job(id), {kRoom}));
  auto database = Database::open(path);
  REQUIRE(database);
  CHECK(refusal(database->execute("UPDATE job SET state = 'done'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'running'")) == ErrorCode::conflict);
  CHECK(refusal(database->execute("UPDATE job SET state = 'succeeded', finished = 1")) ==
        ErrorCode::conflict);
}
