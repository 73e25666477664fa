#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/os/unique_fd.h"

namespace fairway {

/// A piece of a body: text, then bytes of the file.
struct FilePiece {
  std::string before;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// A body out of one file, in pieces.
struct FileBody {
  UniqueFd file;
  std::vector<FilePiece> pieces;

  /// Of the whole body.
  std::uint64_t size() const;
};

/// Reads a FileBody from its start to its end; never more of it than a call asks for.
class FileBodyReader {
 public:
  explicit FileBodyReader(FileBody body);

  /// The next bytes, at most `space.size()` > 0. 0: it is over, or the file is shorter than was
  /// said or cannot be read.
  std::size_t read(std::span<char> space);

 private:
  FileBody body_;
  std::size_t piece_ = 0;
  std::uint64_t at_ = 0;  ///< within the piece
};

}  // namespace fairway
