#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/result.h"
#include "proto/messages/format.h"
#include "proto/messages/job_options.h"
#include "proto/messages/parameters.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/blob_store.h"

namespace fairway {

/// What a multipart body may have beyond the mesh: the parameters and the framing of the parts.
inline constexpr std::uint64_t kUploadOverhead = 128 * 1024;
/// Longest parameter document.
inline constexpr std::size_t kMaxParameterBytes = 64 * 1024;

/// Most parts of a multipart body, `params` among them.
inline constexpr std::size_t kMaxUploadParts = 16;

/// What a query says of an upload.
struct UploadQuery {
  std::optional<std::string> parameters = {};    ///< ?params=
  std::optional<JobOptions> options = {};        ///< ?label=…&priority=&ttl=&deadline=&webhook=
  std::optional<std::string> input_sha256 = {};  ///< ?input=sha256:…, in place of a body
  std::optional<std::string> upload = {};        ///< ?upload=ID, in place of a body

  bool names_input() const { return input_sha256 || upload; }
};

/// Whether the request makes a job, and may say more of it than its parameters.
enum class UploadUse { job, inspection };

/// A mesh in the spool and what to do with it. Not durable yet.
struct Upload {
  std::unique_ptr<BlobDraft> mesh;  ///< null where the query names what came before
  Format format = Format::glb;
  std::size_t files = 1;  ///< more than one: the draft is a Bundle of so many files
  std::string digest;     ///< of these files in whatever order; "" where there is one
  Parameters parameters;
  JobOptions options;
};

/// Whether `needed` bytes have a place beside those that are to stay free. Errors: storage_full,
/// io.
Result<void> check_disk(BlobStore& blobs, std::uint64_t min_free, std::uint64_t needed);

/// Errors: bad_request (unknown key, one twice), invalid_parameters.
Result<UploadQuery> read_upload_query(const HttpRequest& request, UploadUse use);

/// What can be said against an upload before any of its body has been read. Errors: too_large,
/// length_required, unsupported_format (a content encoding), bad_request (unknown query key),
/// malformed_parameters, invalid_parameters.
Result<void> check_upload(const HttpRequest& request, UploadUse use, std::uint64_t max_mesh_bytes);

/// Streams an upload that passed check_upload() into the spool: a raw mesh with `?params=`, or
/// multipart/form-data with at most one part `params`, at most one part `job` (for a job), a mesh
/// and the files that it names. Never more than one piece of a file is in memory. Errors: as
/// check_upload(), FileSpool, BodySource, BlobDraft.
Result<Upload> receive_upload(const HttpRequest& request, UploadUse use, BodySource& body,
                              BlobStore& blobs, std::uint64_t max_mesh_bytes);

}  // namespace fairway
