#pragma once

#include <cstdint>
#include <memory>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/work/job_wait.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// A real store with one queued job, and a board.
class JobFixture {
 public:
  JobFixture() {
    auto jobs = SqliteJobStore::open(directory_.path() / "jobs.sqlite");
    REQUIRE(jobs);
    jobs_ = std::move(*jobs);
    NewJob job;
    job.name.id = random_id();
    job.input = {"in", 1, "aa"};
    job.parameters = "{}";
    const auto submitted = jobs_->submit(job, {1});
    REQUIRE(submitted);
    job_ = submitted->job;
  }

  JobWatch watch() {
    return {*jobs_, board, stop.get_token(), [this] { return client_is_there; }};
  }
  /// The job gets a worker; nobody is told.
  void start() { REQUIRE(jobs_->claim("test", std::chrono::hours(1))); }
  void cancel() { REQUIRE(jobs_->cancel({job_.tenant, job_.id})); }
  std::int64_t number() const { return job_.number; }

  JobBoard board;
  std::stop_source stop;
  bool client_is_there = true;

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<JobStore> jobs_;
  Job job_;
};

}  // namespace fairway::test
