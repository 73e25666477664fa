#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

inline constexpr std::size_t kRoom = 100;
inline const Error kCrash{ErrorCode::worker_crashed, "The worker ended."};

inline NewJob new_job(const std::string& id) {
  NewJob job;
  job.name.id = id;
  job.input = {"in-" + id, 10, "aa"};
  job.parameters = "{}";
  job.fingerprint = "print of " + id;
  return job;
}

/// A store that can be closed and opened again, as a restart of the server does.
class JobStoreFixture {
 public:
  JobStoreFixture() { reopen(); }

  void reopen() {
    store_.reset();
    auto opened = SqliteJobStore::open(path());
    REQUIRE(opened);
    store_ = std::move(*opened);
  }
  std::filesystem::path path() const { return directory_.path() / "jobs.sqlite"; }
  JobStore& store() { return *store_; }

  std::string submit() { return submit(new_job(random_id())); }
  std::string submit(const NewJob& job) {
    const auto submitted = store().submit(job, {kRoom});
    REQUIRE(submitted);
    CHECK(submitted->is_new);
    CHECK(submitted->job.state == JobState::queued);
    return job.name.id;
  }
  Claim claim(std::chrono::milliseconds lease = std::chrono::seconds(60)) {
    auto claimed = store().claim("host", lease);
    REQUIRE(claimed);
    REQUIRE(*claimed);
    return **claimed;
  }
  Job find(const std::string& id) {
    auto job = store().find(JobName{.id = id});
    REQUIRE(job);
    return *job;
  }

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<JobStore> store_;
};

inline Success success_of(const std::string& id) {
  return {{"out-" + id, 20, "bb"}, Format::drc, R"({"steps":3})"};
}

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

}  // namespace fairway::test
