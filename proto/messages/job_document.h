#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "proto/messages/format.h"
#include "proto/messages/job_options.h"
#include "proto/messages/json.h"
#include "proto/messages/worker_protocol.h"

namespace fairway {

/// Where a job stands. The last four are final for the work; `expired` is final for the payload.
enum class JobState : std::uint8_t { queued, running, succeeded, failed, canceled, expired };

/// "queued" …
std::string_view name_of(JobState state);
std::optional<JobState> job_state_of_name(std::string_view name);

/// True once no worker will touch the job any more.
constexpr bool is_final(JobState state) {
  return state != JobState::queued && state != JobState::running;
}

/// A point in time as milliseconds since 1970-01-01T00:00:00Z.
using UnixMillis = std::int64_t;

/// "2024-05-01T12:34:56.789Z" (RFC 3339, UTC).
std::string rfc3339_utc(UnixMillis time);

/// A payload as a client sees it.
struct PayloadFacts {
  Format format = Format::glb;
  std::uint64_t bytes = 0;
  std::string sha256;     ///< 64 lower-case hexadecimal digits
  std::size_t files = 1;  ///< that it was uploaded as; shown where there are several
};

/// Everything a client may know about a job. What is not known yet is absent from the document.
struct JobFacts {
  std::string id;
  JobState state = JobState::queued;
  std::int64_t revision = 1;  ///< grows with every change of state
  int attempt = 1;            ///< 1-based; grows when a worker dies
  UnixMillis created = 0;
  std::optional<UnixMillis> started;
  std::optional<UnixMillis> finished;
  PayloadFacts input;
  Json parameters;  ///< as resolved, see parameters_document()
  JobOptions options;
  bool cached = false;                        ///< the result is that of an earlier job
  std::optional<UnixMillis> expires;          ///< when input and result go
  std::optional<std::size_t> queue_position;  ///< of a queued job among its tenant's, from 1
  std::optional<Progress> progress;           ///< of a running job
  std::optional<Error> problem;               ///< why it failed
  Json report;                                ///< of a succeeded job; null before
  std::optional<PayloadFacts> result;
};

/// The job document of the API: id, state, revision, attempt, created, started, finished,
/// expires_at, cached, queue_position, labels, priority, ttl, deadline, webhook {url, without its
/// query}, input, parameters, progress, problem, report, result {bytes, media_type, sha256}, links
/// {self, events, result, cancel, retry, deliveries}: only the links that can be followed now.
/// Total.
Json job_document(const JobFacts& job);

}  // namespace fairway
