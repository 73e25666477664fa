// The contract of UploadStore, and how a job takes an upload.
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_upload_store.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

/// The stores of jobs and uploads of one database.
class Fixture {
 public:
  Fixture() {
    auto jobs = SqliteJobStore::open(directory_.path() / "jobs.sqlite");
    auto uploads = SqliteUploadStore::open(directory_.path() / "jobs.sqlite");
    REQUIRE((jobs && uploads));
    jobs_ = std::move(*jobs);
    uploads_ = std::move(*uploads);
  }
  JobStore& jobs() { return *jobs_; }
  UploadStore& uploads() { return *uploads_; }

  UploadName add(std::uint64_t length = 10) {
    UploadName name{"local", random_id()};
    REQUIRE(uploads().create({name, length, "a b", std::chrono::hours(1)}, {}));
    return name;
  }
  static NewJob job_of(const UploadName& upload) {
    NewJob job;
    job.name.id = random_id();
    job.input = {"in-" + job.name.id, 10, "aa"};
    job.parameters = "{}";
    job.fingerprint = "print";
    job.upload = upload.id;
    return job;
  }

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<JobStore> jobs_;
  std::unique_ptr<UploadStore> uploads_;
};

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

}  // namespace

TEST_CASE("an upload is found as it was created, by its tenant, until it is removed") {
  Fixture f;
  const UploadName name = f.add(123);
  const auto found = f.uploads().find(name);
  REQUIRE(found);
  CHECK(found->length == 123);
  CHECK(found->metadata == "a b");
  CHECK_FALSE(found->used);
  CHECK(refusal(f.uploads().find({"other", name.id})) == ErrorCode::not_found);
  CHECK(refusal(f.uploads().extend({"other", name.id})) == ErrorCode::not_found);
  CHECK(refusal(f.uploads().remove({"other", name.id})) == ErrorCode::not_found);
  CHECK(f.uploads().open_uploads()->size() == 1);
  REQUIRE(f.uploads().remove(name));
  CHECK(refusal(f.uploads().find(name)) == ErrorCode::not_found);
  CHECK(f.uploads().open_uploads()->empty());
}

TEST_CASE("an upload's time begins anew with its bytes, and ends") {
  Fixture f;
  const UploadName name = f.add();
  const UnixMillis before = f.uploads().find(name)->expires;
  const UnixMillis later = f.uploads().extend(name)->expires;
  CHECK(later >= before);
  CHECK(f.uploads().due(later - 1, 10)->empty());
  CHECK(f.uploads().due(later, 10)->size() == 1);
  CHECK(*f.uploads().expire(name, later - 1) == false);
  CHECK(*f.uploads().expire(name, later) == true);
  CHECK(*f.uploads().expire(name, later) == false);
  const UploadName brief{"local", random_id()};
  REQUIRE(f.uploads().create({brief, 1, "", std::chrono::milliseconds(1)}, {}));
  const auto until = wall_clock() + 2;
  while (wall_clock() < until) {
  }
  CHECK(refusal(f.uploads().find(brief)) == ErrorCode::gone);
}

TEST_CASE("open uploads of a tenant are bounded, in number and in bytes") {
  Fixture f;
  const UploadLimits limits{2, 100};
  const auto create = [&](const std::string& tenant, std::uint64_t length) {
    return f.uploads().create({{tenant, random_id()}, length, "", std::chrono::hours(1)}, limits);
  };
  REQUIRE(create("a", 60));
  CHECK(refusal(create("a", 41)) == ErrorCode::quota_exceeded);
  REQUIRE(create("a", 40));
  CHECK(refusal(create("a", 1)) == ErrorCode::rate_limited);
  CHECK(create("b", 100));
  // What is kept of jobs counts, too, and the other way round.
  NewJob job = Fixture::job_of({});
  job.name.tenant = std::string("b");
  CHECK(refusal(f.jobs().submit(job, {10, 100})) == ErrorCode::quota_exceeded);
  CHECK(f.jobs().submit(job, {10, 110}));
}

TEST_CASE("one job takes an upload, in the moment in which it is stored") {
  Fixture f;
  const UploadName name = f.add();
  NewJob job = Fixture::job_of(name);
  job.idempotency_key = std::string("key");
  // A submit that is refused takes nothing.
  CHECK(refusal(f.jobs().submit(job, {0})) == ErrorCode::queue_full);
  CHECK(refusal(f.jobs().submit(job, {10, 9})) == ErrorCode::quota_exceeded);
  CHECK_FALSE(f.uploads().find(name)->used);
  REQUIRE(f.jobs().submit(job, {10, 10}));
  const auto used = f.uploads().find(name);
  REQUIRE(used);
  REQUIRE(used->used);
  CHECK(used->used->sha256 == "aa");
  CHECK(f.uploads().open_uploads()->empty());
  const auto again = f.jobs().submit(job, {10});
  REQUIRE(again);
  CHECK_FALSE(again->is_new);
  CHECK(refusal(f.jobs().submit(Fixture::job_of(name), {10})) == ErrorCode::gone);
  CHECK(refusal(f.jobs().submit(Fixture::job_of({"", "none"}), {10})) == ErrorCode::gone);
  CHECK(f.jobs().counts()->by_state.at(JobState::queued) == 1);
}

TEST_CASE("an upload of another tenant is nobody's input") {
  Fixture f;
  NewJob job = Fixture::job_of(f.add());
  job.name.tenant = std::string("other");
  CHECK(refusal(f.jobs().submit(job, {10})) == ErrorCode::gone);
}
