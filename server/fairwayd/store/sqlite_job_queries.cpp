// What is asked about the jobs of the store.

#include "server/fairwayd/store/job_row.h"
#include "server/fairwayd/store/job_state.h"
#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

// A job with all labels of a JSON array, or any where it is empty.
#define FAIRWAY_WITH_LABELS                                                                \
  "(json_array_length(?2) = 0 OR json_array_length(?2) = (SELECT count(*) FROM job_label " \
  "WHERE job = seq AND label IN (SELECT value FROM json_each(?2))))"
constexpr std::string_view kList =
    "SELECT " FAIRWAY_JOB_COLUMNS " FROM job WHERE tenant = ?1 AND " FAIRWAY_WITH_LABELS
    " AND (?3 IS NULL OR state = ?3) AND (?4 IS NULL OR seq < ?4) "
    "ORDER BY seq DESC LIMIT ?5";
// Where few jobs have the label they are found by it.
constexpr std::string_view kListLabeled =
    "SELECT " FAIRWAY_JOB_COLUMNS
    " FROM job WHERE seq IN (SELECT job FROM job_label WHERE label = ?6) "
    "AND tenant = ?1 AND " FAIRWAY_WITH_LABELS
    " AND (?3 IS NULL OR state = ?3) AND (?4 IS NULL OR seq < ?4) ORDER BY seq DESC LIMIT ?5";
constexpr std::string_view kCount =
    "SELECT state, count(*) FROM job WHERE tenant = ?1 AND " FAIRWAY_WITH_LABELS " GROUP BY state";
constexpr std::string_view kCountLabeled =
    "SELECT state, count(*) FROM job WHERE seq IN (SELECT job FROM job_label WHERE label = ?3) "
    "AND tenant = ?1 AND " FAIRWAY_WITH_LABELS " GROUP BY state";
#undef FAIRWAY_WITH_LABELS
constexpr std::string_view kCountStates = "SELECT state, count(*) FROM job GROUP BY state";
constexpr std::string_view kOldestCreated =
    "SELECT created FROM job WHERE state = 'queued' ORDER BY seq LIMIT 1";
constexpr std::string_view kProbe =
    "INSERT INTO probe (id, at) VALUES (1, ?) ON CONFLICT (id) DO UPDATE SET at = excluded.at";
constexpr std::string_view kBefore =
    "SELECT count(*) FROM job WHERE tenant = ?1 AND state = 'queued' "
    "AND (priority > ?2 OR (priority = ?2 AND seq < ?3))";
constexpr std::string_view kInput =
    "SELECT " FAIRWAY_JOB_COLUMNS
    " FROM job WHERE tenant = ? AND input_sha256 = ? AND state <> 'expired' "
    "ORDER BY seq DESC LIMIT 1";
constexpr std::string_view kDue =
    "SELECT tenant, id FROM job WHERE expires <= ? ORDER BY expires LIMIT ?";
constexpr std::string_view kForget = "DELETE FROM job WHERE state = 'expired' AND finished < ?";
constexpr std::string_view kNeeded =
    "SELECT input_key FROM job WHERE state <> 'expired' "
    "UNION SELECT result_key FROM job WHERE result_key IS NOT NULL";

/// Binds tenant and labels.
Query& bind_scope(Query& query, const JobQuery& of) {
  return query.bind(of.tenant).bind(dump_json(Json(of.labels)));
}

/// Rows of a state's name and a number.
Result<StateCounts> read_counts(Query rows) {
  StateCounts counts;
  for (const JobState state : kJobStates) counts[state] = 0;
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return counts;
    const auto state = job_state_of_name(rows.text(0));
    if (state) counts[*state] = static_cast<std::size_t>(rows.integer(1));
  }
}

}  // namespace

Result<Job> SqliteJobStore::find(const JobName& name) {
  const std::lock_guard lock(reader_mutex_);
  return load(reader_, name);
}

Result<Job> SqliteJobStore::find(std::int64_t number) {
  const std::lock_guard lock(reader_mutex_);
  return load(reader_, number);
}

Result<JobPage> SqliteJobStore::list(const JobQuery& query) {
  const std::lock_guard lock(reader_mutex_);
  Query rows = reader_.query(query.labels.empty() ? kList : kListLabeled);
  bind_scope(rows, query);
  query.state ? rows.bind(name_of(*query.state)) : rows.bind_null();
  rows.bind(query.before);
  // One more than asked for tells whether there are more.
  rows.bind(static_cast<std::int64_t>(query.limit) + 1);
  if (!query.labels.empty()) rows.bind(query.labels.front());
  auto jobs = read_jobs(std::move(rows));
  if (!jobs) return jobs.error();
  JobPage page{std::move(*jobs), false};
  if (page.jobs.size() > query.limit) {
    page.has_more = true;
    page.jobs.pop_back();
  }
  return page;
}

Result<StateCounts> SqliteJobStore::count(const JobQuery& query) {
  const std::lock_guard lock(reader_mutex_);
  Query rows = reader_.query(query.labels.empty() ? kCount : kCountLabeled);
  bind_scope(rows, query);
  if (!query.labels.empty()) rows.bind(query.labels.front());
  return read_counts(std::move(rows));
}

Result<JobCounts> SqliteJobStore::counts() {
  const std::lock_guard lock(reader_mutex_);
  auto by_state = read_counts(reader_.query(kCountStates));
  if (!by_state) return by_state.error();
  JobCounts counts{*std::move(by_state), {}};
  Query oldest = reader_.query(kOldestCreated);
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
  return database_.check_file();
}

Result<std::size_t> SqliteJobStore::jobs_before(const Job& job) {
  const std::lock_guard lock(reader_mutex_);
  Query query = reader_.query(kBefore);
  query.bind(job.tenant).bind(std::int64_t{job.options.priority}).bind(job.number);
  auto row = query.step();
  if (!row) return row.error();
  return static_cast<std::size_t>(query.integer(0));
}

Result<Job> SqliteJobStore::find_input(std::string_view tenant, std::string_view sha256) {
  const std::lock_guard lock(reader_mutex_);
  auto jobs = read_jobs(std::move(reader_.query(kInput).bind(tenant).bind(sha256)));
  if (!jobs) return jobs.error();
  if (jobs->empty()) {
    return Error{ErrorCode::not_found, "No input with this SHA-256 is kept: send the file."};
  }
  return std::move(jobs->front());
}

Result<std::vector<JobName>> SqliteJobStore::due(UnixMillis now, std::size_t limit) {
  const std::lock_guard lock(mutex_);
  std::vector<JobName> names;
  Query rows = database_.query(kDue);
  rows.bind(now).bind(static_cast<std::int64_t>(limit));
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return names;
    names.push_back({rows.text(0), rows.text(1)});
  }
}

Result<std::size_t> SqliteJobStore::forget(UnixMillis time) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kForget);
  if (auto done = query.bind(time).step(); !done) return done.error();
  return static_cast<std::size_t>(database_.changes());
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

}  // namespace fairway
