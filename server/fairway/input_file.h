#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "core/result.h"
#include "proto/formats/byte_chain.h"
#include "proto/messages/format.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// The bytes of a regular file, mapped read-only.
class InputFile {
 public:
  /// Errors: io.
  static Result<InputFile> open(const std::string& path);
  /// Maps what a descriptor refers to; the descriptor may be closed afterwards. Errors: io.
  static Result<InputFile> map(int fd);

  InputFile(InputFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  explicit InputFile(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::span<const std::byte> bytes_;
};

/// The format that an output file's extension chooses. Errors: usage (it names none).
Result<Format> format_of_output(const std::string& file_name);

/// Writes a file whole or not at all, over any older one. Errors: io, storage_full.
Result<void> write_file(const std::string& path, const ByteChain& bytes);

}  // namespace fairway
