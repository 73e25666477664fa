#include "server/fairwayd/sqlite_job_store.h"

#include <utility>

#include "proto/messages/problem.h"
#include "server/fairwayd/clocks.h"
#include "server/fairwayd/job_schema.h"
#include "server/fairwayd/job_state.h"

namespace fairway {
namespace {

// The columns in the order of job_of(). A macro, because SQL texts are literals put together at
// compile time: the statement cache keys on them.
#define FAIRWAY_JOB_COLUMNS                                                                   \
  "id, state, revision, attempt, fence, created, started, finished, input_key, input_bytes, " \
  "input_sha256, input_format, parameters, problem, report, result_key, result_bytes, "       \
  "result_sha256, result_format, input_files, trace_id"

constexpr std::string_view kFind = "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE id = ?";
constexpr std::string_view kListAll =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job ORDER BY seq DESC LIMIT ?";
constexpr std::string_view kListState =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = ? ORDER BY seq DESC LIMIT ?";
constexpr std::string_view kOldestQueued =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = 'queued' ORDER BY seq LIMIT 1";
constexpr std::string_view kHeldBy =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = 'running' AND lease_owner = ?";
constexpr std::string_view kLeaseOver =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE state = 'running' AND lease_until < ?";
#undef FAIRWAY_JOB_COLUMNS

constexpr std::string_view kCountQueued = "SELECT count(*) FROM job WHERE state = 'queued'";
constexpr std::string_view kCountStates = "SELECT state, count(*) FROM job GROUP BY state";
constexpr std::string_view kOldestCreated =
    "SELECT created FROM job WHERE state = 'queued' ORDER BY seq LIMIT 1";
constexpr std::string_view kProbe =
    "INSERT INTO probe (id, at) VALUES (1, ?) ON CONFLICT (id) DO UPDATE SET at = excluded.at";
constexpr std::string_view kInsert =
    "INSERT INTO job (id, state, revision, attempt, fence, created, input_key, input_bytes, "
    "input_sha256, input_format, parameters, input_files, trace_id) "
    "VALUES (?, 'queued', 1, 1, 0, ?, ?, ?, ?, ?, ?, ?, ?)";
constexpr std::string_view kMove =
    "UPDATE job SET state = ?, revision = revision + 1, attempt = ?, fence = ?, lease_owner = ?, "
    "lease_until = ?, started = ?, finished = ?, problem = ?, report = ?, result_key = ?, "
    "result_bytes = ?, result_sha256 = ?, result_format = ? "
    "WHERE id = ? AND revision = ? RETURNING revision";
constexpr std::string_view kExtend =
    "UPDATE job SET lease_until = ? WHERE id = ? AND fence = ? AND state = 'running'";
constexpr std::string_view kNeeded =
    "SELECT input_key FROM job WHERE state IN ('queued','running') "
    "UNION ALL SELECT result_key FROM job WHERE state = 'succeeded'";

std::optional<std::int64_t> optional_integer(const Query& query, int column) {
  if (query.is_null(column)) return std::nullopt;
  return query.integer(column);
}

std::optional<Error> stored_problem(const Query& query, int column) {
  if (query.is_null(column)) return std::nullopt;
  auto json = parse_json(query.text(column));
  if (!json) return Error{ErrorCode::internal, "The stored problem cannot be read."};
  return error_of_problem(*json);
}

Job job_of(const Query& row) {
  Job job;
  job.id = row.text(0);
  job.state = job_state_of_name(row.text(1)).value_or(JobState::expired);
  job.revision = row.integer(2);
  job.attempt = static_cast<int>(row.integer(3));
  job.fence = row.integer(4);
  job.created = row.integer(5);
  job.started = optional_integer(row, 6);
  job.finished = optional_integer(row, 7);
  job.input = {row.text(8), static_cast<std::uint64_t>(row.integer(9)), row.text(10)};
  job.input_format = format_of_name(row.text(11)).value_or(Format::glb);
  job.parameters = row.text(12);
  job.problem = stored_problem(row, 13);
  job.report = row.text(14);
  if (!row.is_null(15)) {
    job.result = BlobInfo{row.text(15), static_cast<std::uint64_t>(row.integer(16)), row.text(17)};
    job.result_format = format_of_name(row.text(18)).value_or(Format::glb);
  }
  job.input_files = static_cast<std::size_t>(row.integer(19));
  job.trace_id = row.text(20);
  return job;
}

void bind_result(Query& query, const Job& job) {
  if (!job.result) {
    query.bind_null().bind_null().bind_null().bind_null();
    return;
  }
  query.bind(job.result->key).bind(static_cast<std::int64_t>(job.result->bytes));
  query.bind(job.result->sha256).bind(name_of(job.result_format));
}

Error late() {
  return {ErrorCode::conflict, "The lease on this job is lost: another attempt or a cancel came."};
}

}  // namespace

Result<std::unique_ptr<SqliteJobStore>> SqliteJobStore::open(const std::filesystem::path& path) {
  auto database = Database::open(path);
  if (!database) return database.error();
  if (auto done = migrate_job_schema(*database); !done) return done.error();
  return std::unique_ptr<SqliteJobStore>(new SqliteJobStore(std::move(*database)));
}

Result<Job> SqliteJobStore::submit(const NewJob& job, std::size_t queue_limit) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto queued = count_queued();
  if (!queued) return queued.error();
  if (*queued >= queue_limit) {
    return Error{ErrorCode::queue_full, "The queue is full: try again later."};
  }
  {
    Query insert = database_.query(kInsert);
    insert.bind(job.id).bind(wall_clock()).bind(job.input.key);
    insert.bind(static_cast<std::int64_t>(job.input.bytes)).bind(job.input.sha256);
    insert.bind(name_of(job.input_format)).bind(job.parameters);
    insert.bind(static_cast<std::int64_t>(job.input_files)).bind(job.trace_id);
    if (auto row = insert.step(); !row) return row.error();
  }
  auto stored = load(job.id);
  if (!stored) return stored;
  if (auto done = transaction->commit(); !done) return done.error();
  return stored;
}

Result<std::size_t> SqliteJobStore::queue_length() {
  const std::lock_guard lock(mutex_);
  return count_queued();
}

Result<JobCounts> SqliteJobStore::counts() {
  const std::lock_guard lock(mutex_);
  JobCounts counts;
  for (const JobState state : kJobStates) counts.by_state[state] = 0;
  Query states = database_.query(kCountStates);
  for (;;) {
    auto row = states.step();
    if (!row) return row.error();
    if (!*row) break;
    const auto state = job_state_of_name(states.text(0));
    if (state) counts.by_state[*state] = static_cast<std::size_t>(states.integer(1));
  }
  Query oldest = database_.query(kOldestCreated);
  auto row = oldest.step();
  if (!row) return row.error();
  if (*row) counts.oldest_queued = oldest.integer(0);
  return counts;
}

Result<void> SqliteJobStore::probe() {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kProbe);
  query.bind(wall_clock());
  if (auto done = query.step(); !done) return done.error();
  return {};
}

Result<Job> SqliteJobStore::find(std::string_view id) {
  const std::lock_guard lock(mutex_);
  return load(id);
}

Result<std::vector<Job>> SqliteJobStore::list(const JobQuery& query) {
  const std::lock_guard lock(mutex_);
  const auto limit = static_cast<std::int64_t>(query.limit);
  if (!query.state) return read_all(std::move(database_.query(kListAll).bind(limit)));
  return read_all(std::move(database_.query(kListState).bind(name_of(*query.state)).bind(limit)));
}

Result<std::optional<Claim>> SqliteJobStore::claim(std::string_view owner,
                                                   std::chrono::milliseconds lease) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  const std::int64_t now = monotonic_millis();
  auto lost = read_all(std::move(database_.query(kLeaseOver).bind(now)));
  if (!lost) return lost.error();
  if (auto done = requeue(std::move(*lost)); !done) return done.error();
  auto oldest = read_all(database_.query(kOldestQueued));
  if (!oldest) return oldest.error();
  std::optional<Claim> claim;
  if (!oldest->empty()) {
    Job job = std::move(oldest->front());
    job.fence += 1;
    job.started = wall_clock();
    auto running = move(std::move(job), JobState::running,
                        LeaseHolder{std::string(owner), now + lease.count()});
    if (!running) return running.error();
    claim = Claim{*running, Lease{running->id, running->fence}};
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return claim;
}

Result<void> SqliteJobStore::heartbeat(const Lease& lease, std::chrono::milliseconds extension) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kExtend);
  query.bind(monotonic_millis() + extension.count()).bind(lease.job_id).bind(lease.fence);
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
  auto moved = move(std::move(*job), end);
  if (!moved) return moved;
  if (auto done = transaction->commit(); !done) return done.error();
  return moved;
}

Result<Job> SqliteJobStore::give_back(const Lease& lease) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load_leased(lease);
  if (!job) return job;
  auto moved = move(std::move(*job), JobState::queued);
  if (!moved) return moved;
  if (auto done = transaction->commit(); !done) return done.error();
  return moved;
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
  auto moved = move(std::move(*job), last ? JobState::failed : JobState::queued);
  if (!moved) return moved;
  if (auto done = transaction->commit(); !done) return done.error();
  return moved;
}

Result<Job> SqliteJobStore::cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load(id);
  if (!job || is_final(job->state)) return job;
  job->finished = wall_clock();
  auto moved = move(std::move(*job), JobState::canceled);
  if (!moved) return moved;
  if (auto done = transaction->commit(); !done) return done.error();
  return moved;
}

Result<Job> SqliteJobStore::expire(std::string_view id) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto job = load(id);
  if (!job || job->state == JobState::expired) return job;
  job->result.reset();
  auto moved = move(std::move(*job), JobState::expired);
  if (!moved) return moved;
  if (auto done = transaction->commit(); !done) return done.error();
  return moved;
}

Result<std::size_t> SqliteJobStore::requeue_lost(std::string_view owner) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto held = read_all(std::move(database_.query(kHeldBy).bind(owner)));
  if (!held) return held.error();
  auto count = requeue(std::move(*held));
  if (!count) return count;
  if (auto done = transaction->commit(); !done) return done.error();
  return count;
}

Result<std::vector<std::string>> SqliteJobStore::needed_blobs() {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> keys;
  Query query = database_.query(kNeeded);
  for (;;) {
    auto row = query.step();
    if (!row) return row.error();
    if (!*row) return keys;
    keys.push_back(query.text(0));
  }
}

Result<Job> SqliteJobStore::load(std::string_view id) {
  auto jobs = read_all(std::move(database_.query(kFind).bind(id)));
  if (!jobs) return jobs.error();
  if (jobs->empty()) return Error{ErrorCode::not_found, "There is no job with this id."};
  return std::move(jobs->front());
}

Result<Job> SqliteJobStore::load_leased(const Lease& lease) {
  auto job = load(lease.job_id);
  if (!job) return job;
  if (job->state != JobState::running || job->fence != lease.fence) return late();
  return job;
}

// The one place that writes states. The revision in the condition makes a forgotten transaction
// visible: two moves from the same reading cannot both succeed.
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
  job.problem ? query.bind(dump_json(problem_document(*job.problem))) : query.bind_null();
  job.report.empty() ? query.bind_null() : query.bind(job.report);
  bind_result(query, job);
  query.bind(job.id).bind(job.revision);
  auto row = query.step();
  if (!row) return row.error();
  if (!*row) return late();
  job.state = to;
  job.revision = query.integer(0);
  return job;
}

Result<std::size_t> SqliteJobStore::requeue(std::vector<Job> jobs) {
  for (Job& job : jobs) {
    if (auto moved = move(std::move(job), JobState::queued); !moved) return moved.error();
  }
  return jobs.size();
}

Result<std::vector<Job>> SqliteJobStore::read_all(Query query) {
  std::vector<Job> jobs;
  for (;;) {
    auto row = query.step();
    if (!row) return row.error();
    if (!*row) return jobs;
    jobs.push_back(job_of(query));
  }
}

Result<std::size_t> SqliteJobStore::count_queued() {
  Query query = database_.query(kCountQueued);
  auto row = query.step();
  if (!row) return row.error();
  return static_cast<std::size_t>(query.integer(0));
}

}  // namespace fairway
