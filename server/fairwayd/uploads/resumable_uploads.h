#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/upload_store.h"
#include "server/fairwayd/uploads/upload_metadata.h"
#include "server/fairwayd/uploads/uploads_in_flight.h"

namespace fairway {

/// How far an upload is.
struct UploadState {
  ResumableUpload upload;
  std::uint64_t offset = 0;  ///< bytes that are there, durable
};

/// What a client says of the bytes that it sends.
struct UploadChunk {
  std::uint64_t offset = 0;                  ///< where they belong
  std::optional<std::uint64_t> bytes;        ///< how many, where it says so
  std::optional<ExpectedChecksum> checksum;  ///< without it what comes counts as it comes
};

/// Uploads in as many requests as they take: rows in the store, bytes as files of one directory. A
/// file's length is the offset, so that there is nothing to bring into step after a crash. All
/// operations may be called from any thread. Errors of all: io, storage_full, those of UploadStore.
class ResumableUploads {
 public:
  struct Options {
    std::uint64_t max_bytes = std::uint64_t{512} << 20;  ///< of one upload
    std::uint64_t min_free = 0;                          ///< bytes to leave on the disk
    std::chrono::milliseconds keep = std::chrono::hours(24);
    UploadLimits limits = {};
  };

  /// Makes the directory where it is absent. The stores must outlive the uploads.
  static Result<std::unique_ptr<ResumableUploads>> open(UploadStore& store, BlobStore& blobs,
                                                        const std::filesystem::path& directory,
                                                        const Options& options);

  /// Removes files without a row and rows without a file, which a dead server left behind. Before
  /// any other operation. Returns how many.
  Result<std::size_t> recover();

  /// An upload without a byte. Errors: bad_request (the metadata), too_large.
  Result<ResumableUpload> create(const std::string& tenant, std::uint64_t length,
                                 std::string_view metadata);

  /// Errors: not_found, gone (expired, or it has become a job).
  Result<UploadState> state(const UploadName& name);

  /// Adds the body to the upload. Of a body that is cut short, what came stays, unless it has a
  /// checksum: then all of it counts or nothing. A client that comes again may be here before the
  /// end of its broken connection is known: an earlier request with bytes is interrupted. Errors:
  /// as state(), conflict (the bytes belong elsewhere, or the earlier request does not end),
  /// too_large, checksum_mismatch, BodySource.
  Result<UploadState> append(const UploadName& name, const UploadChunk& chunk, BodySource& body);

  /// Errors: as state().
  Result<void> remove(const UploadName& name);

  /// An upload that is whole, or was when a job took it. Errors: not_found, gone (expired),
  /// not_ready.
  Result<ResumableUpload> whole(const UploadName& name);

  /// Of a whole upload that no job has taken, by its metadata and first bytes. Errors:
  /// recognise_format().
  Result<Format> recognise(const ResumableUpload& upload);

  /// The bytes of a whole upload as a payload under `key`; the upload stays.
  Result<BlobInfo> give(const ResumableUpload& upload, std::string_view key);

  /// Removes the bytes of an upload that a job has taken.
  Result<void> drop_bytes(const UploadName& name);

  /// Removes uploads whose time is over at `now`, except those that bytes are coming for. Returns
  /// how many.
  Result<std::size_t> sweep(UnixMillis now);

  std::uint64_t max_bytes() const { return options_.max_bytes; }

 private:
  ResumableUploads(UploadStore& store, BlobStore& blobs, std::filesystem::path directory,
                   const Options& options)
      : store_(store), blobs_(blobs), directory_(std::move(directory)), options_(options) {}

  std::filesystem::path path_of(const UploadName& name) const { return directory_ / name.id; }
  Result<ResumableUpload> find_open(const UploadName& name);
  Result<void> receive(int file, std::uint64_t left, const UploadChunk& chunk, BodySource& body);

  UploadStore& store_;
  BlobStore& blobs_;
  const std::filesystem::path directory_;
  const Options options_;
  UploadsInFlight in_flight_;
};

}  // namespace fairway
