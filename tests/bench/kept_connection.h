#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway::bench {

struct Reply {
  int status = 0;
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;

  /// "" where there is none.
  std::string header(const std::string& lower_name) const;
};

/// One connection to a server on the loopback that carries request after request. As lean as a
/// client can be, so that what is measured is the server. SIGPIPE must be ignored.
class KeptConnection {
 public:
  explicit KeptConnection(std::uint16_t port) : port_(port) {}

  using Headers = std::vector<std::pair<std::string_view, std::string>>;

  /// Asks for /livez, connecting anew where the server has closed: the next request finds the
  /// connection warm. Errors: unavailable.
  Result<void> warm();

  /// Sends a request and reads its whole answer. Errors: unavailable (no connection, nothing within
  /// two minutes), bad_request (an answer without a length).
  Result<Reply> ask(std::string_view method, std::string_view path, const Headers& headers = {},
                    std::span<const std::byte> body = {});

 private:
  Result<void> connect();
  bool is_open() const;
  bool receive();
  Result<Reply> read_head();
  Result<void> read_body(Reply& reply);

  std::uint16_t port_;
  UniqueFd socket_;
  std::string received_;  ///< and not yet used
};

}  // namespace fairway::bench
