#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/messages/format.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/os/sha256.h"

namespace fairway {

/// too_large, for what is above the limit of an upload.
Error upload_too_large(std::uint64_t limit);

/// What a FileSpool has received.
struct SpooledFiles {
  Format format = Format::glb;  ///< of the mesh
  std::size_t count = 1;
  std::string digest = {};  ///< SHA-256 of the files in whatever order; "" where there is one
};

/// The files of an upload on their way into one spooled payload: a single file as it is, several as
/// a Bundle. Only the first bytes of each stay in memory.
class FileSpool {
 public:
  /// `limit`: most bytes of all files together. The draft must outlive the spool.
  FileSpool(BlobDraft& draft, std::uint64_t limit) : draft_(draft), limit_(limit) {}

  /// The next file begins. Its name is the part's file name, or the part's name where there is
  /// none. Errors: bad_request (too many files, an impossible name, one that came already).
  Result<void> begin(const PartHead& part);

  /// More bytes of this file. Errors: too_large, recognise_format() of a part named mesh,
  /// BlobDraft.
  Result<void> append(std::span<const std::byte> bytes);

  /// After the last byte of the last file. Which file is the mesh: the only one; the part named
  /// mesh; else the one whose name ends as a mesh format's; else the one whose first bytes are a
  /// mesh's. Errors: bad_request (no file, no mesh, several candidates), recognise_format(),
  /// BlobDraft.
  Result<SpooledFiles> finish();

 private:
  struct File {
    std::string name;
    std::string type;  ///< declared
    bool is_part_mesh = false;
    std::uint64_t bytes = 0;
    std::vector<std::byte> head;  ///< the first kMagicBytes
    std::string sha256 = {};      ///< where there are several files, once the file is over
  };

  static Result<Format> recognise(const File& file);
  static int claim_to_be_mesh(const File& file);
  Result<std::size_t> find_mesh() const;
  Result<void> end_file();
  std::string digest(std::size_t mesh) const;

  BlobDraft& draft_;
  const std::uint64_t limit_;
  std::uint64_t count_ = 0;  ///< bytes of all files
  std::vector<File> files_;
  Sha256 hash_;  ///< of the file at hand, from the second on
};

}  // namespace fairway
