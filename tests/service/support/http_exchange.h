#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/service/support/http_client.h"

namespace fairway::test {

/// A request as it is written on the wire. "Connection: close" is added.
struct WireRequest {
  std::string method;
  std::string path;
  std::vector<std::string> headers;  ///< "Name: value"
  std::string body;
  bool says_length = true;  ///< send Content-Length
};

/// Sends a request in a connection of its own and waits long for its answer. Any method and any
/// header go out as they are. Status 0: no answer came.
Answer exchange(std::uint16_t port, const WireRequest& request);

/// The answer that a whole message is, its chunks put together. Status 0: it is none.
Answer parsed_answer(std::string_view message);

}  // namespace fairway::test
