#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/sqlite.h"

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

  Result<Submission> submit(const NewJob& job, const SubmitLimits& limits) override;
  Result<bool> has_submit(const JobName& name, std::string_view key) override;
  Result<std::size_t> queue_length() override;
  Result<void> check_room(std::string_view tenant, std::uint64_t bytes,
                          const SubmitLimits& limits) override;
  Result<JobCounts> counts() override;
  Result<void> probe() override;
  Result<Job> find(const JobName& name) override;
  Result<Job> find(std::int64_t number) override;
  Result<JobPage> list(const JobQuery& query) override;
  Result<StateCounts> count(const JobQuery& query) override;
  Result<std::size_t> jobs_before(const Job& job) override;
  Result<Job> find_input(std::string_view tenant, std::string_view sha256) override;
  Result<std::optional<Claim>> claim(std::string_view owner,
                                     std::chrono::milliseconds lease) override;
  Result<void> heartbeat(const Lease& lease, std::chrono::milliseconds extension) override;
  Result<Job> finish(const Lease& lease, const Outcome& outcome) override;
  Result<Job> give_back(const Lease& lease) override;
  Result<Job> worker_died(const Lease& lease, const Error& cause) override;
  Result<Job> cancel(const JobName& name) override;
  Result<Job> retry(const JobName& name, std::size_t queue_limit) override;
  Result<Expiry> expire(const JobName& name) override;
  Result<std::vector<JobName>> due(UnixMillis now, std::size_t limit) override;
  Result<std::size_t> forget(UnixMillis time) override;
  Result<std::size_t> requeue_lost(std::string_view owner) override;
  Result<std::vector<std::string>> needed_blobs() override;

 private:
  SqliteJobStore(Database database, Database reader)
      : database_(std::move(database)), reader_(std::move(reader)) {}

  static Result<Job> load(Database& database, const JobName& name);
  static Result<Job> load(Database& database, std::int64_t number);
  Result<Job> load_leased(const Lease& lease);
  Result<Job> move(Job job, JobState to, const LeaseHolder& holder = {});
  Result<Job> move_alone(Transaction transaction, Job job, JobState to);
  Result<std::size_t> requeue(std::vector<Job> jobs);
  static Result<std::size_t> count_queued(Database& database);
  static Result<void> check_queue(Database& database, std::string_view tenant,
                                  std::size_t queue_limit);
  Result<void> use_upload(const NewJob& job);
  Result<std::optional<Job>> find_submitted(const NewJob& job);
  Result<std::optional<Job>> find_content(const NewJob& job);
  Result<std::int64_t> insert(const NewJob& job, const std::optional<Job>& like);
  Result<void> enter_turn(const std::string& tenant);
  Result<std::optional<Job>> next_in_turn();
  Result<bool> is_needed(const std::string& key);

  std::mutex mutex_;
  Database database_;
  // What only reads must not wait for the disk, or for a lock, behind the commits of others.
  std::mutex reader_mutex_;
  Database reader_;
};

}  // namespace fairway
