#include "server/fairwayd/store/sqlite_job_store.h"

#include <utility>

#include "proto/messages/problem.h"
#include "server/fairwayd/store/job_row.h"
#include "server/fairwayd/store/job_schema.h"
#include "server/fairwayd/store/job_state.h"
#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/kill_point.h"

namespace fairway {
namespace {

constexpr std::string_view kFind =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE tenant = ? AND id = ?";
constexpr std::string_view kFindNumber = "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE seq = ?";
constexpr std::string_view kHeldBy =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = 'running' AND lease_owner = ?";
constexpr std::string_view kLeaseOver =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = 'running' AND lease_until < ?";
// Stride scheduling: every claim moves a tenant on by the inverse of its weight, and who is least
// far goes next.
constexpr std::string_view kNextTenant =
    "SELECT name FROM tenant t WHERE EXISTS "
    "(SELECT 1 FROM job WHERE tenant = t.name AND state = 'queued') "
    "AND (most_running IS NULL OR most_running > "
    "(SELECT count(*) FROM job WHERE tenant = t.name AND state = 'running')) "
    "ORDER BY pass, name LIMIT 1";
constexpr std::string_view kNextJob =
    "SELECT " FAIRWAY_JOB_COLUMNS
    " FROM job WHERE tenant = ? AND state = 'queued' ORDER BY priority DESC, seq LIMIT 1";
constexpr std::string_view kTurn = "UPDATE tenant SET pass = pass + 1 / weight WHERE name = ?";
constexpr std::string_view kMove =
    "UPDATE job SET state = ?, revision = revision + 1, attempt = ?, fence = ?, lease_owner = ?, "
    "lease_until = ?, started = ?, finished = ?, expires = ? + keep, problem = ?, report = ?, "
    "result_key = ?, result_bytes = ?, result_sha256 = ?, result_format = ? "
    "WHERE seq = ? AND revision = ? RETURNING revision, expires";
constexpr std::string_view kExtend =
    "UPDATE job SET lease_until = ? WHERE seq = ? AND fence = ? AND state = 'running'";
constexpr std::string_view kStillNeeded =
    "SELECT 1 FROM job WHERE (input_key = ?1 AND state <> 'expired') OR result_key = ?1 LIMIT 1";

Error late() {
  return {ErrorCode::conflict, "The lease on this job is lost: another attempt or a cancel came."};
}

}  // namespace

Result<std::unique_ptr<SqliteJobStore>> SqliteJobStore::open(const std::filesystem::path& path) {
  auto database = Database::open(path);
  if (!database) return database.error();
  if (auto done = migrate_job_schema(*database); !done) return done.error();
  auto reader = Database::open(path);
  if (!reader) return reader.error();
  return std::unique_ptr<SqliteJobStore>(
      new SqliteJobStore(std::move(*database), std::move(*reader)));
}

Result<std::optional<Claim>> SqliteJobStore::claim(std::string_view owner,
                                                   std::chrono::milliseconds lease) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  const std::int64_t now = monotonic_millis();
  auto lost = read_jobs(std::move(database_.query(kLeaseOver).bind(now)));
  if (!lost) return lost.error();
  if (auto done = requeue(std::move(*lost)); !done) return done.error();
  auto job = next_in_turn();
  if (!job) return job.error();
  std::optional<Claim> claim;
  if (*job) {
    (*job)->fence += 1;
    (*job)->started = wall_clock();
    auto running = move(**std::move(job), JobState::running,
                        LeaseHolder{std::string(owner), now + lease.count()});
    if (!running) return running.error();
    claim = Claim{*running, Lease{running->number, running->fence}};
    kill_point("claim.commit");
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return claim;
}

Result<void> SqliteJobStore::heartbeat(const Lease& lease, std::chrono::milliseconds extension) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kExtend);
  query.bind(monotonic_millis() + extension.count()).bind(lease.job).bind(lease.fence);
  if (auto done = query.step(); !done) return done.error();
  if (database_.changes() == 0) return late();
  return {};
}

Result<Job> SqliteJobStore::finish(const Lease& lease, const Outcome& outcome) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load_leased(lease);
  if (!job) return job;
  job->finished = wall_clock();
  JobState end = JobState::failed;
  if (const auto* success = std::get_if<Success>(&outcome)) {
    job->result = success->output;
    job->result_format = success->format;
    job->report = success->report;
    end = JobState::succeeded;
  } else {
    job->problem = std::get<Error>(outcome);
  }
  kill_point("finish.update");
  auto moved = move(std::move(*job), end);
  if (!moved) return moved;
  kill_point("finish.commit");
  if (auto done = transaction->commit(); !done) return done.error();
  kill_point("finish.committed");
  return moved;
}

Result<Job> SqliteJobStore::give_back(const Lease& lease) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load_leased(lease);
  if (!job) return job;
  return move_alone(std::move(*transaction), std::move(*job), JobState::queued);
}

Result<Job> SqliteJobStore::worker_died(const Lease& lease, const Error& cause) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load_leased(lease);
  if (!job) return job;
  const bool last = job->attempt >= kMaxWorkerDeaths;
  if (last) {
    job->problem = cause;
    job->finished = wall_clock();
  } else {
    job->attempt += 1;
  }
  return move_alone(std::move(*transaction), std::move(*job),
                    last ? JobState::failed : JobState::queued);
}

Result<Job> SqliteJobStore::cancel(const JobName& name) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load(database_, name);
  if (!job || is_final(job->state)) return job;
  job->finished = wall_clock();
  return move_alone(std::move(*transaction), std::move(*job), JobState::canceled);
}

Result<Job> SqliteJobStore::retry(const JobName& name, std::size_t queue_limit) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load(database_, name);
  if (!job) return job;
  if (job->state != JobState::failed && job->state != JobState::canceled) {
    return Error{ErrorCode::conflict, "Only a job that failed or was canceled is done again."};
  }
  if (auto room = check_queue(database_, job->tenant, queue_limit); !room) return room.error();
  if (auto done = enter_turn(job->tenant); !done) return done.error();
  job->attempt = 1;
  job->started.reset();
  job->finished.reset();
  job->problem.reset();
  return move_alone(std::move(*transaction), std::move(*job), JobState::queued);
}

Result<Expiry> SqliteJobStore::expire(const JobName& name) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load(database_, name);
  if (!job) return job.error();
  if (job->state == JobState::expired) return Expiry{std::move(*job), {}};
  std::vector<std::string> keys = {job->input.key};
  if (job->result) keys.push_back(job->result->key);
  job->result.reset();
  auto moved = move(std::move(*job), JobState::expired);
  if (!moved) return moved.error();
  Expiry expiry{std::move(*moved), {}};
  for (std::string& key : keys) {
    const auto needed = is_needed(key);
    if (!needed) return needed.error();
    if (!*needed) expiry.blobs.push_back(std::move(key));
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return expiry;
}

Result<std::size_t> SqliteJobStore::requeue_lost(std::string_view owner) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto held = read_jobs(std::move(database_.query(kHeldBy).bind(owner)));
  if (!held) return held.error();
  auto count = requeue(std::move(*held));
  if (!count) return count;
  if (auto done = transaction->commit(); !done) return done.error();
  return count;
}

Result<Job> SqliteJobStore::load(Database& database, const JobName& name) {
  auto jobs = read_jobs(std::move(database.query(kFind).bind(name.tenant).bind(name.id)));
  if (!jobs) return jobs.error();
  if (jobs->empty()) return Error{ErrorCode::not_found, "There is no job with this id."};
  return std::move(jobs->front());
}

Result<Job> SqliteJobStore::load(Database& database, std::int64_t number) {
  auto jobs = read_jobs(std::move(database.query(kFindNumber).bind(number)));
  if (!jobs) return jobs.error();
  if (jobs->empty()) return Error{ErrorCode::not_found, "There is no job with this number."};
  return std::move(jobs->front());
}

/// Of the tenant whose turn it is.
Result<std::optional<Job>> SqliteJobStore::next_in_turn() {
  std::string tenant;
  {
    Query query = database_.query(kNextTenant);
    auto row = query.step();
    if (!row) return row.error();
    if (!*row) return std::optional<Job>();
    tenant = query.text(0);
  }
  auto jobs = read_jobs(std::move(database_.query(kNextJob).bind(tenant)));
  if (!jobs) return jobs.error();
  if (jobs->empty()) return std::optional<Job>();
  Query turn = database_.query(kTurn);
  if (auto done = turn.bind(tenant).step(); !done) return done.error();
  return std::optional(std::move(jobs->front()));
}

Result<bool> SqliteJobStore::is_needed(const std::string& key) {
  Query query = database_.query(kStillNeeded);
  return query.bind(key).step();
}

Result<Job> SqliteJobStore::load_leased(const Lease& lease) {
  auto job = load(database_, lease.job);
  if (!job) return job;
  if (job->state != JobState::running || job->fence != lease.fence) return late();
  return job;
}

// The one place that writes states. The revision in the condition makes a forgotten transaction
// visible: two moves from the same reading cannot both succeed. What a webhook is to be told of the
// move stands or falls with it.
Result<Job> SqliteJobStore::move(Job job, JobState to, const LeaseHolder& holder) {
  if (!may_follow(job.state, to)) {
    return Error{ErrorCode::conflict, "The job is in a state that does not allow this."};
  }
  Query query = database_.query(kMove);
  query.bind(name_of(to)).bind(std::int64_t{job.attempt}).bind(job.fence);
  if (to == JobState::running) {
    query.bind(holder.owner).bind(holder.until);
  } else {
    query.bind_null().bind_null();
  }
  query.bind(job.started).bind(job.finished);
  query.bind(to == JobState::expired ? std::nullopt : job.finished);
  job.problem ? query.bind(dump_json(problem_document(*job.problem))) : query.bind_null();
  job.report.empty() ? query.bind_null() : query.bind(job.report);
  bind_result(query, job);
  query.bind(job.number).bind(job.revision);
  auto row = query.step();
  if (!row) return row.error();
  if (!*row) return late();
  job.state = to;
  job.revision = query.integer(0);
  job.expires = query.is_null(1) ? std::nullopt : std::optional(query.integer(1));
  if (auto told = add_delivery(database_, job); !told) return told.error();
  return job;
}

/// A move that is all of its transaction.
Result<Job> SqliteJobStore::move_alone(Transaction transaction, Job job, JobState to) {
  auto moved = move(std::move(job), to);
  if (!moved) return moved;
  if (auto done = transaction.commit(); !done) return done.error();
  return moved;
}

Result<std::size_t> SqliteJobStore::requeue(std::vector<Job> jobs) {
  for (Job& job : jobs) {
    if (auto moved = move(std::move(job), JobState::queued); !moved) return moved.error();
  }
  return jobs.size();
}

}  // namespace fairway
