// How jobs come into the store.

#include <fmt/format.h>

#include "server/fairwayd/store/job_row.h"
#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/store/tenant_quota.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/kill_point.h"

namespace fairway {
namespace {

constexpr std::string_view kFindKey =
    "SELECT " FAIRWAY_JOB_COLUMNS ", fingerprint FROM job WHERE tenant = ? AND idempotency_key = ?";
constexpr std::string_view kFindId =
    "SELECT " FAIRWAY_JOB_COLUMNS ", fingerprint FROM job WHERE tenant = ? AND id = ?";
constexpr int kFingerprint = 26;  // the column behind those of the job
constexpr std::string_view kHasSubmit =
    "SELECT EXISTS (SELECT 1 FROM job WHERE tenant = ?1 AND id = ?2) OR "
    "EXISTS (SELECT 1 FROM job WHERE tenant = ?1 AND idempotency_key = ?3)";
constexpr std::string_view kFindContent =
    "SELECT " FAIRWAY_JOB_COLUMNS
    " FROM job WHERE tenant = ? AND content = ? AND state = 'succeeded' ORDER BY seq DESC LIMIT 1";
constexpr std::string_view kCountQueued = "SELECT count(*) FROM job WHERE state = 'queued'";
constexpr std::string_view kTenantQueue =
    "SELECT most_queued, (SELECT count(*) FROM job WHERE tenant = name AND state = 'queued') "
    "FROM tenant WHERE name = ?";
constexpr std::string_view kAddTenant =
    "INSERT INTO tenant (name) VALUES (?) ON CONFLICT DO NOTHING";
// Who was away does not catch up on the turns that he did not want.
constexpr std::string_view kEnterTurn =
    "UPDATE tenant SET pass = max(pass, coalesce((SELECT min(pass) FROM tenant t WHERE EXISTS "
    "(SELECT 1 FROM job WHERE tenant = t.name AND state IN ('queued','running'))), pass)) "
    "WHERE name = ?1 AND NOT EXISTS "
    "(SELECT 1 FROM job WHERE tenant = ?1 AND state IN ('queued','running'))";
constexpr std::string_view kInsert =
    "INSERT INTO job (tenant, id, state, revision, attempt, fence, created, started, finished, "
    "keep, expires, priority, options, cached, idempotency_key, fingerprint, content, input_key, "
    "input_bytes, input_sha256, input_format, input_files, parameters, trace_id, report, "
    "result_key, result_bytes, result_sha256, result_format) "
    "VALUES (?, ?, ?, 1, 1, 0, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
    "?) "
    "RETURNING seq";
constexpr std::string_view kUseUpload =
    "UPDATE upload SET sha256 = ?, format = ?, expires = ? + keep "
    "WHERE tenant = ? AND id = ? AND length = ? AND sha256 IS NULL";
constexpr std::string_view kAddLabel = "INSERT INTO job_label (job, label) VALUES (?, ?)";

void bind_or_null(Query& query, const std::string& text) {
  text.empty() ? query.bind_null() : query.bind(text);
}

struct Found {
  Job job;
  std::string fingerprint;
};

Result<std::optional<Found>> find_one(Query query) {
  auto row = query.step();
  if (!row) return row.error();
  if (!*row) return std::optional<Found>();
  return std::optional(Found{job_of(query), query.text(kFingerprint)});
}

}  // namespace

Result<Submission> SqliteJobStore::submit(const NewJob& job, const SubmitLimits& limits) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto there = find_submitted(job);
  if (!there) return there.error();
  if (*there) return Submission{**std::move(there), false};
  auto like = find_content(job);
  if (!like) return like.error();
  if (!*like) {
    if (auto room = check_queue(database_, job.name.tenant, limits.queue); !room)
      return room.error();
  }
  // An upload is kept once, as the job's input, from here on.
  if (!job.upload.empty()) {
    if (auto used = use_upload(job); !used) return used.error();
  }
  if (auto room =
          check_tenant_quota(database_, job.name.tenant, job.input.bytes, limits.tenant_bytes);
      !room) {
    return room.error();
  }
  if (!job.owns_input) {
    const auto kept = is_needed(job.input.key);
    if (!kept) return kept.error();
    if (!*kept) return Error{ErrorCode::not_found, "The input is no longer kept: send the file."};
  }
  if (auto done = enter_turn(job.name.tenant); !done) return done.error();
  const auto number = insert(job, *like);
  if (!number) return number.error();
  auto stored = load(database_, *number);
  if (!stored) return stored.error();
  // One that shares a result has ended by being made.
  if (auto told = add_delivery(database_, *stored); !told) return told.error();
  kill_point("submit.commit");
  if (auto done = transaction->commit(); !done) return done.error();
  kill_point("submit.committed");
  return Submission{std::move(*stored), true};
}

Result<bool> SqliteJobStore::has_submit(const JobName& name, std::string_view key) {
  const std::lock_guard lock(reader_mutex_);
  Query query = reader_.query(kHasSubmit);
  auto row = query.bind(name.tenant).bind(name.id).bind(key).step();
  if (!row) return row.error();
  return query.integer(0) != 0;
}

/// The upload becomes the input of this job, and of no other one.
Result<void> SqliteJobStore::use_upload(const NewJob& job) {
  Query query = database_.query(kUseUpload);
  query.bind(job.input.sha256).bind(name_of(job.input_format)).bind(wall_clock());
  query.bind(job.name.tenant).bind(job.upload).bind(static_cast<std::int64_t>(job.input.bytes));
  if (auto done = query.step(); !done) return done.error();
  if (database_.changes() > 0) return {};
  return Error{ErrorCode::gone,
               fmt::format("The upload has become a job, or is no longer kept: say "
                           "input=sha256:{}, or send the file again.",
                           job.input.sha256)};
}

/// The job that an earlier try of the same submit has made.
Result<std::optional<Job>> SqliteJobStore::find_submitted(const NewJob& job) {
  const auto& [tenant, id] = job.name;
  if (!job.idempotency_key.empty()) {
    auto found =
        find_one(std::move(database_.query(kFindKey).bind(tenant).bind(job.idempotency_key)));
    if (!found) return found.error();
    if (*found && (*found)->fingerprint != job.fingerprint) {
      return Error{ErrorCode::key_reused,
                   "This Idempotency-Key came with another request before: use a new one."};
    }
    if (*found) return std::optional((*found)->job);
  }
  auto found = find_one(std::move(database_.query(kFindId).bind(tenant).bind(id)));
  if (!found) return found.error();
  if (!*found) return std::optional<Job>();
  if (job.fingerprint.empty() || (*found)->fingerprint != job.fingerprint) {
    return Error{ErrorCode::conflict, "There is another job with this id: choose a new one."};
  }
  return std::optional((*found)->job);
}

/// A job of the same content that has a result.
Result<std::optional<Job>> SqliteJobStore::find_content(const NewJob& job) {
  if (job.content.empty() || !job.may_share) return std::optional<Job>();
  auto found =
      read_jobs(std::move(database_.query(kFindContent).bind(job.name.tenant).bind(job.content)));
  if (!found) return found.error();
  if (found->empty()) return std::optional<Job>();
  return std::optional(std::move(found->front()));
}

/// Where there is a job `like` it, it has succeeded with that one's blobs.
Result<std::int64_t> SqliteJobStore::insert(const NewJob& job, const std::optional<Job>& like) {
  const UnixMillis now = wall_clock();
  const std::optional<std::int64_t> ended = like ? std::optional(now) : std::nullopt;
  const std::optional<std::int64_t> expires =
      like ? std::optional(now + job.keep.count()) : std::nullopt;
  const BlobInfo& input = like ? like->input : job.input;
  std::int64_t number = 0;
  {
    Query query = database_.query(kInsert);
    query.bind(job.name.tenant).bind(job.name.id);
    query.bind(name_of(like ? JobState::succeeded : JobState::queued));
    query.bind(now).bind(ended).bind(ended).bind(std::int64_t{job.keep.count()}).bind(expires);
    query.bind(std::int64_t{job.options.priority});
    query.bind(dump_json(job_options_document(job.options)));
    query.bind(std::int64_t{like ? 1 : 0});
    bind_or_null(query, job.idempotency_key);
    query.bind(job.fingerprint);
    bind_or_null(query, job.content);
    query.bind(input.key).bind(static_cast<std::int64_t>(input.bytes)).bind(input.sha256);
    query.bind(name_of(job.input_format)).bind(static_cast<std::int64_t>(job.input_files));
    query.bind(job.parameters).bind(job.trace_id);
    bind_or_null(query, like ? like->report : std::string());
    bind_result(query, like.value_or(Job{}));
    auto row = query.step();
    if (!row) return row.error();
    number = query.integer(0);
  }
  for (const std::string& label : job.options.labels) {
    Query query = database_.query(kAddLabel);
    if (auto done = query.bind(number).bind(label).step(); !done) return done.error();
  }
  return number;
}

/// Before the tenant's job is in the queue.
Result<void> SqliteJobStore::enter_turn(const std::string& tenant) {
  for (const std::string_view sql : {kAddTenant, kEnterTurn}) {
    Query query = database_.query(sql);
    if (auto done = query.bind(tenant).step(); !done) return done.error();
  }
  return {};
}

Result<void> SqliteJobStore::check_room(std::string_view tenant, std::uint64_t bytes,
                                        const SubmitLimits& limits) {
  const std::lock_guard lock(reader_mutex_);
  if (auto room = check_queue(reader_, tenant, limits.queue); !room) return room;
  return check_tenant_quota(reader_, tenant, bytes, limits.tenant_bytes);
}

Result<void> SqliteJobStore::check_queue(Database& database, std::string_view tenant,
                                         std::size_t queue_limit) {
  const auto queued = count_queued(database);
  if (!queued) return queued.error();
  if (*queued >= queue_limit) {
    return Error{ErrorCode::queue_full, "The queue is full: try again later."};
  }
  Query query = database.query(kTenantQueue);
  auto row = query.bind(tenant).step();
  if (!row) return row.error();
  if (!*row || query.is_null(0) || query.integer(1) < query.integer(0)) return {};
  return Error{
      ErrorCode::queue_full,
      fmt::format("{} jobs wait, which is all that this tenant may have waiting: try again "
                  "later.",
                  query.integer(1))};
}

Result<std::size_t> SqliteJobStore::count_queued(Database& database) {
  Query query = database.query(kCountQueued);
  auto row = query.step();
  if (!row) return row.error();
  return static_cast<std::size_t>(query.integer(0));
}

Result<std::size_t> SqliteJobStore::queue_length() {
  const std::lock_guard lock(reader_mutex_);
  return count_queued(reader_);
}

}  // namespace fairway
