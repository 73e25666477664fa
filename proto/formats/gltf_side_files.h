#pragma once

#include <string>
#include <vector>

#include "proto/formats/json_fields.h"
#include "proto/formats/side_files.h"

namespace fairway {

/// An image of a glTF that came as a file of its own.
struct SideImage {
  std::size_t index = 0;  ///< in "images"
  ByteSpan bytes;
  std::string media_type;  ///< "application/octet-stream" where it is not known
};

/// Reads the files beside a document and keeps count of them.
class SideReader {
 public:
  /// `files` must outlive the reader.
  explicit SideReader(const SideFiles& files) : files_(files) {}

  /// The bytes that the "uri" of `place` names. Errors: invalid_mesh (a URI that is refused), io,
  /// too_large (all reads together above 1 GiB).
  Result<ByteSpan> read(const JsonPlace& place, std::string_view uri);

  bool has_files() const { return static_cast<bool>(files_); }
  /// Bytes of all that were read.
  std::uint64_t total() const { return total_; }

 private:
  const SideFiles& files_;
  std::uint64_t total_ = 0;
};

/// The images that files hold. Nothing is computed with them, so one that cannot be read stays the
/// reference that it is, with a note. Without side files nothing is read and nothing noted. Errors:
/// invalid_mesh (no list of objects), too_large.
Result<std::vector<SideImage>> read_side_images(const JsonPlace& root, SideReader& reader,
                                                std::vector<std::string>& notes);

}  // namespace fairway
