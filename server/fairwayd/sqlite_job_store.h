#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "server/fairwayd/job_store.h"
#include "server/fairwayd/sqlite.h"

namespace fairway {

/// Who holds a running job, and until when on the store's clock.
struct LeaseHolder {
  std::string owner;
  std::int64_t until = 0;
};

/// Jobs in one SQLite file (WAL, synchronous=FULL) of one server. Lease time is the machine's
/// monotonic clock; after a restart of the machine requeue_lost() returns what was leased before.
class SqliteJobStore final : public JobStore {
 public:
  /// Opens or creates the file and brings its schema up to date. Errors: unavailable, storage_full,
  /// conflict (written by a newer fairwayd).
  static Result<std::unique_ptr<SqliteJobStore>> open(const std::filesystem::path& path);

  Result<Job> submit(const NewJob& job, std::size_t queue_limit) override;
  Result<std::size_t> queue_length() override;
  Result<JobCounts> counts() override;
  Result<void> probe() override;
  Result<Job> find(std::string_view id) override;
  Result<std::vector<Job>> list(const JobQuery& query) override;
  Result<std::optional<Claim>> claim(std::string_view owner,
                                     std::chrono::milliseconds lease) override;
  Result<void> heartbeat(const Lease& lease, std::chrono::milliseconds extension) override;
  Result<Job> finish(const Lease& lease, const Outcome& outcome) override;
  Result<Job> give_back(const Lease& lease) override;
  Result<Job> worker_died(const Lease& lease, const Error& cause) override;
  Result<Job> cancel(std::string_view id) override;
  Result<Job> expire(std::string_view id) override;
  Result<std::size_t> requeue_lost(std::string_view owner) override;
  Result<std::vector<std::string>> needed_blobs() override;

 private:
  explicit SqliteJobStore(Database database) : database_(std::move(database)) {}

  Result<Job> load(std::string_view id);
  Result<Job> load_leased(const Lease& lease);
  Result<Job> move(Job job, JobState to, const LeaseHolder& holder = {});
  Result<std::size_t> requeue(std::vector<Job> jobs);
  Result<std::vector<Job>> read_all(Query query);
  Result<std::size_t> count_queued();

  std::mutex mutex_;
  Database database_;
};

}  // namespace fairway
