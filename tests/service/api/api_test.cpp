// The API over real stores, without sockets and workers.
#include "server/fairwayd/api/api.h"

#include <functional>
#include <string>

#include <catch2/catch.hpp>
#include <fcntl.h>

#include "server/fairwayd/store/directory_blob_store.h"
#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/store/sqlite_upload_store.h"
#include "server/fairwayd/work/worker_pool.h"
#include "server/os/file.h"
#include "server/os/random_id.h"
#include "tests/places.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

/// A raw body that lets something happen while it arrives.
class SlowBody final : public BodySource {
 public:
  SlowBody(std::string bytes, std::function<void()> meanwhile)
      : bytes_(std::move(bytes)), meanwhile_(std::move(meanwhile)) {}

  Result<void> read(const OnBytes& on_bytes) override {
    meanwhile_();
    return on_bytes(std::as_bytes(std::span(bytes_.data(), bytes_.size())));
  }
  Result<void> read_parts(const OnPart&, const OnBytes&) override {
    return Error{ErrorCode::bad_request, "Not multipart."};
  }
  void interrupt() override {}

 private:
  std::string bytes_;
  std::function<void()> meanwhile_;
};

class Fixture {
 public:
  explicit Fixture(std::size_t queue_limit) {
    auto jobs = SqliteJobStore::open(directory_.path() / "jobs.sqlite");
    auto blobs = DirectoryBlobStore::open(this->blobs(), directory_.path() / "spool");
    REQUIRE((jobs && blobs));
    auto outbox = SqliteOutbox::open(directory_.path() / "jobs.sqlite");
    REQUIRE(outbox);
    outbox_ = std::move(*outbox);
    jobs_ = std::move(*jobs);
    blobs_ = std::move(*blobs);
    auto rows = SqliteUploadStore::open(directory_.path() / "jobs.sqlite");
    REQUIRE(rows);
    upload_rows_ = std::move(*rows);
    auto uploads =
        ResumableUploads::open(*upload_rows_, *blobs_, directory_.path() / "uploads", {});
    REQUIRE(uploads);
    uploads_ = std::move(*uploads);
    supervisor_ = std::make_unique<Supervisor>(*jobs_, *blobs_, board_, workers_, metrics_, log_,
                                               SupervisorOptions{});
    api_ = std::make_unique<Api>(
        *jobs_, *blobs_, *uploads_, *outbox_, board_, *supervisor_, metrics_, gate_, log_,
        ApiOptions{std::uint64_t{1} << 20, queue_limit}, std::stop_token());
  }

  HttpResponse submit(std::function<void()> meanwhile = [] {}) {
    HttpRequest request;
    request.method = "POST";
    request.path = "/v1/jobs";
    request.content_type = "model/gltf-binary";
    request.has_length = true;
    SlowBody body(test::small_glb(), std::move(meanwhile));
    return api_->answer(request, body);
  }
  std::filesystem::path blobs() const { return directory_.path() / "blobs"; }
  JobStore& jobs() { return *jobs_; }

 private:
  test::TemporaryDirectory directory_;
  UniqueFd null_{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
  Log log_{null_.get()};
  JobBoard board_;
  WorkerPool workers_{test::program("fairway"), {}, 0, log_};  // never started
  ServiceMetrics metrics_{"test"};
  const Gate gate_{nullptr};
  std::unique_ptr<JobStore> jobs_;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<UploadStore> upload_rows_;
  std::unique_ptr<ResumableUploads> uploads_;
  std::unique_ptr<Outbox> outbox_;
  std::unique_ptr<Supervisor> supervisor_;
  std::unique_ptr<Api> api_;
};

}  // namespace

TEST_CASE("a 202 is given when the input and the job are both stored") {
  Fixture f(1);
  CHECK(f.submit().status == 202);
  const auto jobs = f.jobs().list({});
  REQUIRE(jobs);
  REQUIRE(jobs->jobs.size() == 1);
  CHECK(std::filesystem::exists(f.blobs() / jobs->jobs.front().input.key));
}

TEST_CASE("an upload that loses the race for the last place in the queue keeps nothing") {
  Fixture f(1);
  const auto response = f.submit([&] {
    NewJob other;
    other.name.id = random_id();
    other.input = {"in-other", 1, "aa"};
    other.parameters = "{}";
    REQUIRE(f.jobs().submit(other, {1}));
  });
  CHECK(response.status == 429);
  CHECK(response.close);
  CHECK(std::filesystem::is_empty(f.blobs()));
}
