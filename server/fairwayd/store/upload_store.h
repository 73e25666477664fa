#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/messages/format.h"
#include "proto/messages/job_document.h"

namespace fairway {

/// Whose upload, and its id of the server's making (see random_id()).
struct UploadName {
  std::string tenant;
  std::string id;
};

/// What a job has taken of an upload.
struct UsedUpload {
  std::string sha256;
  Format format = Format::glb;
};

/// A file on its way, in as many requests as it takes. How much of it has come is not kept here:
/// the length of its file is the truth.
struct ResumableUpload {
  UploadName name;
  std::uint64_t length = 0;        ///< in bytes, of the whole; above 0
  std::string metadata;            ///< Upload-Metadata as it came
  UnixMillis expires = 0;          ///< moves on with every request that brings bytes
  std::optional<UsedUpload> used;  ///< it has become the input of a job
};

/// What create() needs.
struct NewUpload {
  UploadName name;
  std::uint64_t length = 0;
  std::string metadata;
  std::chrono::milliseconds keep{std::chrono::hours(24)};
};

/// What a tenant may have.
struct UploadLimits {
  std::size_t most_open = 100;     ///< uploads that no job has taken
  std::uint64_t tenant_bytes = 0;  ///< see SubmitLimits
};

/// The rows of resumable uploads. All operations are atomic and durable when they return, and may
/// be called from any thread. That a job takes an upload is written by JobStore::submit(), in the
/// transaction that stores the job. Errors of all: unavailable, storage_full, internal.
class UploadStore {
 public:
  virtual ~UploadStore() = default;

  /// The whole length counts as kept from now on. Errors: rate_limited (too many are open),
  /// quota_exceeded.
  virtual Result<ResumableUpload> create(const NewUpload& upload, const UploadLimits& limits) = 0;

  /// Errors: not_found, gone (its time is over).
  virtual Result<ResumableUpload> find(const UploadName& name) = 0;

  /// Bytes came: its time begins anew. Errors: not_found.
  virtual Result<ResumableUpload> extend(const UploadName& name) = 0;

  /// Errors: not_found.
  virtual Result<void> remove(const UploadName& name) = 0;

  /// At most `limit` uploads whose time is over at `now`, those that a job has taken too.
  virtual Result<std::vector<UploadName>> due(UnixMillis now, std::size_t limit) = 0;

  /// Removes it if its time is over at `now`. False: it is not, or there is none.
  virtual Result<bool> expire(const UploadName& name, UnixMillis now) = 0;

  /// Those that no job has taken.
  virtual Result<std::vector<UploadName>> open_uploads() = 0;
};

}  // namespace fairway
