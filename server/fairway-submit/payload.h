#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "proto/messages/json.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// `text` with all that is not a letter or digit percent-encoded.
std::string url_encoded(std::string_view text);

/// What is uploaded for one file: its own bytes, or a form where it names other files or the
/// parameters are too long for a URL. Read from the disk while it is sent.
class Payload {
 public:
  /// Errors: io (no regular file, or not readable).
  static Result<Payload> open(const std::filesystem::path& input, const Json& parameters);

  /// Bytes of the request's body.
  std::uint64_t size() const { return size_; }
  const std::string& content_type() const { return content_type_; }
  /// "?params=…", or "" where they are part of the form.
  const std::string& query() const { return query_; }
  /// Digest of all files and the parameters: equal ones ask for the same.
  const std::string& digest() const { return digest_; }
  /// SHA-256 that the server must state for the input; empty for several files.
  const std::string& input_sha256() const { return input_sha256_; }

  /// Reads from `offset` of the body on; returns how many bytes, 0 at its end or where a file has
  /// shrunk. Errors: io.
  Result<std::size_t> read(std::uint64_t offset, std::span<char> space) const;

 private:
  /// Part of the body: text, or the whole of a file.
  struct Piece {
    std::string text;
    UniqueFd file;
    std::uint64_t begin = 0;
    std::uint64_t bytes = 0;
  };

  Payload() = default;
  void add(std::string text);
  Result<std::string> add(UniqueFd file);

  std::vector<Piece> pieces_;
  std::uint64_t size_ = 0;
  std::string content_type_;
  std::string query_;
  std::string digest_;
  std::string input_sha256_;
};

}  // namespace fairway
