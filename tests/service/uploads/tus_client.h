#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/service/support/http_client.h"

namespace fairway::test {

/// Speaks tus 1.0.0 with a service.
class TusClient {
 public:
  using Headers = HttpClient::Headers;

  /// `always`: headers of every request.
  explicit TusClient(HttpClient client, Headers always = {})
      : client_(client), always_(std::move(always)) {
    always_.emplace("Tus-Resumable", "1.0.0");
  }

  Answer create(std::uint64_t length, const Headers& more = {}) const;
  /// Creates an upload and returns its path; fails the test where it is refused.
  std::string created(std::uint64_t length, const Headers& more = {}) const;
  Answer patch(const std::string& path, std::uint64_t offset, const std::string& bytes,
               const Headers& more = {}) const;
  Answer head(const std::string& path) const;
  Answer remove(const std::string& path) const;

  /// What HEAD says; fails the test where there is no upload.
  std::uint64_t offset(const std::string& path) const;
  /// An upload with all its bytes; its path.
  std::string upload(const std::string& bytes, const Headers& more = {}) const;

 private:
  Headers with(const Headers& more) const;

  HttpClient client_;
  Headers always_;
};

/// The id at the end of an upload's path.
std::string id_of_upload(const std::string& path);

/// "key <text in base64>", of Upload-Metadata.
std::string metadata_pair(const std::string& key, std::string_view text);

/// The head of a PATCH as text, of `length` bytes.
std::string patch_head(const std::string& path, std::uint64_t offset, std::uint64_t length);

std::string sha256_of(const std::string& text);

}  // namespace fairway::test
