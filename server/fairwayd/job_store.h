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
#include "server/fairwayd/blob_store.h"

namespace fairway {

/// A job as it is stored.
struct Job {
  std::string id;  ///< see random_id()
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
  std::optional<Error> problem;       ///< exactly if failed
  std::string report;                 ///< JSON; empty unless succeeded
  std::optional<BlobInfo> result;     ///< exactly if succeeded
  Format result_format = Format::glb;
  std::string trace_id;  ///< of the submit, see TraceContext; empty where it is not known
};

/// What submit() needs. The input is durable in the BlobStore before.
struct NewJob {
  std::string id;
  BlobInfo input;
  Format input_format = Format::glb;
  std::string parameters;
  std::size_t input_files = 1;
  std::string trace_id = {};
};

/// The right to work on a job. Every write through it is refused once another claim, a cancel or a
/// hand-back has come in between: the fencing token no longer fits.
struct Lease {
  std::string job_id;
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

/// Which jobs list() returns: the newest `limit`, in one state or in any.
struct JobQuery {
  std::optional<JobState> state;
  std::size_t limit = 50;
};

/// How many jobs there are.
struct JobCounts {
  std::map<JobState, std::size_t> by_state;  ///< every state
  std::optional<UnixMillis> oldest_queued;   ///< when it was created
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

  /// Adds a queued job. `queue_limit`: how many jobs may be queued. Errors: queue_full, conflict
  /// (the id exists).
  virtual Result<Job> submit(const NewJob& job, std::size_t queue_limit) = 0;

  /// How many jobs are queued: lets a server refuse before it reads an upload.
  virtual Result<std::size_t> queue_length() = 0;

  /// How many jobs there are in each state, without reading them.
  virtual Result<JobCounts> counts() = 0;

  /// Writes something and makes it durable, to see whether that works.
  virtual Result<void> probe() = 0;

  /// Errors: not_found.
  virtual Result<Job> find(std::string_view id) = 0;

  /// Newest first.
  virtual Result<std::vector<Job>> list(const JobQuery& query) = 0;

  /// Takes the oldest queued job for the worker host `owner`, for `lease` of time (the store's own
  /// clock, not one that can be set), after returning jobs with an expired lease to the queue.
  /// Nothing, if nothing is queued.
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
  virtual Result<Job> cancel(std::string_view id) = 0;

  /// Marks the payload of a final job as gone; an expired job is returned as it is.
  /// Errors: not_found, conflict (still queued or running).
  virtual Result<Job> expire(std::string_view id) = 0;

  /// The worker host `owner` starts anew: all that it held goes back to the queue, attempt not
  /// counted. Returns how many jobs.
  virtual Result<std::size_t> requeue_lost(std::string_view owner) = 0;

  /// Keys of all blobs that a job still needs; the others may be swept.
  virtual Result<std::vector<std::string>> needed_blobs() = 0;
};

}  // namespace fairway
