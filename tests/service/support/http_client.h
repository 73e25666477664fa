#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "proto/messages/json.h"
#include "server/os/unique_fd.h"

namespace fairway::test {

/// An HTTP answer. Status 0: none came.
struct Answer {
  int status = 0;
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;

  std::string header(const std::string& lower_name) const;
  /// The body as JSON; fails the test where it is none.
  Json json() const;
  /// "code" of a problem document; fails the test where the body is none.
  std::string problem() const;
};

/// A client of a server on the loopback. Every request has a connection of its own.
class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port) : port_(port) {}

  using Headers = std::multimap<std::string, std::string>;

  Answer get(const std::string& path, const Headers& headers = {}) const;
  Answer head(const std::string& path, const Headers& headers = {}) const;
  Answer remove(const std::string& path) const;
  Answer put(const std::string& path, const std::string& body,
             const std::string& type = "text/plain", const Headers& headers = {}) const;
  Answer post(const std::string& path, const std::string& body = {},
              const std::string& type = "application/octet-stream",
              const Headers& headers = {}) const;
  /// A multipart upload with the parts mesh and params.
  Answer post_form(const std::string& path, const std::string& mesh, const std::string& file_name,
                   const std::string& parameters) const;

  /// Any request; a content type is one of the headers.
  Answer send(const std::string& method, const std::string& path, const Headers& headers = {},
              const std::string& body = {}) const;

  /// Sends bytes as they are and returns all that comes until the server closes, or 2 s are over.
  std::string raw(std::string_view bytes) const;

 private:
  std::uint16_t port_;
};

/// A connection to the loopback whose reads wait for `patience`; fails the test where there is
/// none.
UniqueFd connect_to(std::uint16_t port, std::chrono::seconds patience);

/// `text` with all that is not a letter or digit percent-encoded.
std::string percent_encoded(std::string_view text);

}  // namespace fairway::test
