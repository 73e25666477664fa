#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/result.h"
#include "proto/messages/format.h"
#include "proto/messages/job_document.h"
#include "proto/messages/job_options.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_id.h"

namespace fairway {

/// Whose jobs they are where nobody says who he is.
inline constexpr std::string_view kLocalTenant = "local";

/// What a client names a job by. Ids are their tenant's own: another one's job is not found.
struct JobName {
  std::string tenant = std::string(kLocalTenant);
  std::string id;
};

/// A job as it is stored.
struct Job {
  std::int64_t number = 0;  ///< of the store, over all tenants; clients never see it
  std::string tenant;
  std::string id;  ///< see is_job_id()
  JobState state = JobState::queued;
  std::int64_t revision = 1;  ///< grows with every write
  int attempt = 1;            ///< 1-based; grows when a worker dies
  std::int64_t fence = 0;     ///< grows with every claim
  UnixMillis created = 0;
  std::optional<UnixMillis> started;
  std::optional<UnixMillis> finished;
  BlobInfo input;
  Format input_format = Format::glb;  ///< of the mesh
  std::size_t input_files = 1;        ///< more than one: the input is a Bundle of so many files
  std::string parameters;             ///< JSON, as resolved
  JobOptions options;
  bool cached = false;                ///< the result is that of an earlier job
  std::optional<UnixMillis> expires;  ///< when input and result go; exactly if final, not expired
  std::optional<Error> problem;       ///< exactly if failed
  std::string report;                 ///< JSON; empty unless succeeded
  std::optional<BlobInfo> result;     ///< exactly if succeeded
  Format result_format = Format::glb;
  std::string trace_id;  ///< of the submit, see TraceContext; empty where it is not known
};

/// What submit() needs. The input is durable in the BlobStore before.
struct NewJob {
  JobName name;
  BlobInfo input;
  Format input_format = Format::glb;
  std::string parameters;
  std::size_t input_files = 1;
  JobOptions options = {};
  std::chrono::milliseconds keep{std::chrono::hours(24)};  ///< after its end, see Job::expires
  std::string idempotency_key = {};                        ///< "": none
  std::string fingerprint = {};  ///< of all that was sent: equal ones are the same submit
  std::string content = {};      ///< of all that makes the result; "": nobody shares it
  bool may_share = true;         ///< the result of an earlier job will do
  bool owns_input = true;        ///< the input came with this submit; false: it is another job's
  std::string trace_id = {};
  std::string upload = {};  ///< id of the ResumableUpload that becomes the input; "": none
};

/// What a service takes.
struct SubmitLimits {
  std::size_t queue = 256;         ///< jobs that wait, of all tenants
  std::uint64_t tenant_bytes = 0;  ///< of meshes kept of one tenant, unless it has its own; 0 = any
};

/// What became of a submit.
struct Submission {
  Job job;
  bool is_new = true;  ///< false: the same submit came before, and this is its job
};

/// The right to work on a job. Every write through it is refused once another claim, a cancel or a
/// hand-back has come in between: the fencing token no longer fits.
struct Lease {
  std::int64_t job = 0;  ///< its number
  std::int64_t fence = 0;
};

/// A job together with the right to work on it.
struct Claim {
  Job job;
  Lease lease;
};

/// A result that is durable in the BlobStore.
struct Success {
  BlobInfo output;
  Format format = Format::glb;
  std::string report;  ///< JSON
};

using Outcome = std::variant<Success, Error>;

/// Which jobs of a tenant list() returns.
struct JobQuery {
  std::string tenant = std::string(kLocalTenant);
  std::optional<JobState> state = {};
  std::vector<std::string> labels = {};     ///< a job must have all of them
  std::optional<std::int64_t> before = {};  ///< numbers below this one
  std::size_t limit = 50;
};

struct JobPage {
  std::vector<Job> jobs;  ///< newest first
  bool has_more = false;
};

/// How many jobs are in each of all states.
using StateCounts = std::map<JobState, std::size_t>;

/// How many jobs there are.
struct JobCounts {
  StateCounts by_state;
  std::optional<UnixMillis> oldest_queued;  ///< when it was created
};

/// A job whose payload is no longer kept, and the keys of the blobs that no job needs any more.
struct Expiry {
  Job job;
  std::vector<std::string> blobs;
};

/// Where jobs live. All operations are atomic and durable when they return, and may be called from
/// any thread, and by several servers at once where the implementation is shared: API replicas call
/// submit, find, list, cancel, expire; worker hosts call claim, heartbeat, finish, give_back,
/// worker_died. Waiting for changes is not part of it: a JobBoard wakes, the store tells what is.
///
/// Rules every implementation keeps: states change only as may_follow() says; a committed result
/// beats a cancel, a cancel beats a later failure, a late attempt changes nothing.
/// Errors of every operation: unavailable, storage_full, internal, besides those named.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Adds a queued job; where it may share and an earlier one of the tenant with the same `content`
  /// has a result, one that has succeeded with it, and shares its blobs. The same idempotency key,
  /// or the same id, with the same fingerprint returns the job that is there. Errors: queue_full,
  /// quota_exceeded, key_reused (the key came with another fingerprint), conflict (the id did),
  /// not_found (the input of another job is gone), gone (so is the upload, or it has become another
  /// job). With a new job its upload is used up, in the same transaction.
  virtual Result<Submission> submit(const NewJob& job, const SubmitLimits& limits) = 0;

  /// Whether the tenant has a job of this id, or of this idempotency key ("": of none). As the next
  /// two, it waits for nobody's commit.
  virtual Result<bool> has_submit(const JobName& name, std::string_view key) = 0;

  /// How many jobs are queued, of all tenants.
  virtual Result<std::size_t> queue_length() = 0;

  /// Lets a server refuse before it reads an upload of `bytes`. Errors: queue_full,
  /// quota_exceeded.
  virtual Result<void> check_room(std::string_view tenant, std::uint64_t bytes,
                                  const SubmitLimits& limits) = 0;

  /// How many jobs there are in each state, without reading them.
  virtual Result<JobCounts> counts() = 0;

  /// Writes something and makes it durable, to see whether that works.
  virtual Result<void> probe() = 0;

  /// Errors: not_found.
  virtual Result<Job> find(const JobName& name) = 0;
  virtual Result<Job> find(std::int64_t number) = 0;

  virtual Result<JobPage> list(const JobQuery& query) = 0;

  /// How many jobs there are in each state, `state`, `before` and `limit` of the query aside.
  virtual Result<StateCounts> count(const JobQuery& query) = 0;

  /// How many queued jobs of its tenant run before this queued one.
  virtual Result<std::size_t> jobs_before(const Job& job) = 0;

  /// The newest job of the tenant that still has an input of this digest. Errors: not_found.
  virtual Result<Job> find_input(std::string_view tenant, std::string_view sha256) = 0;

  /// Takes a queued job for the worker host `owner`, for `lease` of time (the store's own clock,
  /// not one that can be set), after returning jobs with an expired lease to the queue. Tenants
  /// take turns, of one tenant the highest priority goes first, of that the oldest job. Nothing, if
  /// nothing is queued.
  virtual Result<std::optional<Claim>> claim(std::string_view owner,
                                             std::chrono::milliseconds lease) = 0;

  /// Extends a lease. Not a change of state: the revision stays. Errors: conflict (the lease is
  /// lost, or the job was canceled: stop working).
  virtual Result<void> heartbeat(const Lease& lease, std::chrono::milliseconds extension) = 0;

  /// The job's end, succeeded or failed. Errors: conflict (late; nothing was changed).
  virtual Result<Job> finish(const Lease& lease, const Outcome& outcome) = 0;

  /// Hands a running job back to the queue, attempt not counted. Errors: conflict.
  virtual Result<Job> give_back(const Lease& lease) = 0;

  /// A worker died by itself: back to the queue with attempt + 1, or, at the kMaxWorkerDeaths-th
  /// time, failed with `cause`. Errors: conflict.
  virtual Result<Job> worker_died(const Lease& lease, const Error& cause) = 0;

  /// Cancels a queued or running job; a job in a final state is returned as it is.
  /// Errors: not_found.
  virtual Result<Job> cancel(const JobName& name) = 0;

  /// Puts a failed or canceled job into the queue anew. Errors: not_found, conflict (any other
  /// state), queue_full.
  virtual Result<Job> retry(const JobName& name, std::size_t queue_limit) = 0;

  /// Marks the payload of a final job as gone; an expired job is returned as it is.
  /// Errors: not_found, conflict (still queued or running).
  virtual Result<Expiry> expire(const JobName& name) = 0;

  /// At most `limit` final jobs whose time is over at `now`.
  virtual Result<std::vector<JobName>> due(UnixMillis now, std::size_t limit) = 0;

  /// Removes all trace of expired jobs that ended before `time`. Returns how many.
  virtual Result<std::size_t> forget(UnixMillis time) = 0;

  /// The worker host `owner` starts anew: all that it held goes back to the queue, attempt not
  /// counted. Returns how many jobs.
  virtual Result<std::size_t> requeue_lost(std::string_view owner) = 0;

  /// Keys of all blobs that a job still needs; the others may be swept.
  virtual Result<std::vector<std::string>> needed_blobs() = 0;
};

}  // namespace fairway
