#pragma once

#include <memory>
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/job_wait.h"
#include "server/fairwayd/sqlite_job_store.h"
#include "server/os/random_id.h"
#include "tests/service/temporary_directory.h"

namespace fairway::test {

/// A real store with one queued job, and a board.
class JobFixture {
 public:
  JobFixture() {
    auto jobs = SqliteJobStore::open(directory_.path() / "jobs.sqlite");
    REQUIRE(jobs);
    jobs_ = std::move(*jobs);
    REQUIRE(jobs_->submit({id_, {"in", 1, "aa"}, Format::glb, "{}"}, 1));
  }

  JobWatch watch() {
    return {*jobs_, board, stop.get_token(), [this] { return client_is_there; }};
  }
  /// The job gets a worker; nobody is told.
  void start() { REQUIRE(jobs_->claim("test", std::chrono::hours(1))); }
  void cancel() { REQUIRE(jobs_->cancel(id_)); }
  const std::string& id() const { return id_; }

  JobBoard board;
  std::stop_source stop;
  bool client_is_there = true;

 private:
  TemporaryDirectory directory_;
  std::string id_ = random_id();
  std::unique_ptr<JobStore> jobs_;
};

}  // namespace fairway::test
