#pragma once

#include <string>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// What a worker waits for: its order as it was sent, and what it is to read and to write.
struct ReceivedOrder {
  std::string line;  ///< without its '\n'; not yet parsed
  UniqueFd input;
  UniqueFd output;
};

/// Waits on the socket for an order, for as long as it takes. Errors: canceled (the server has
/// closed, or is gone), malformed_input (a line without the two descriptors, or without an end).
Result<ReceivedOrder> receive_order(int socket);

}  // namespace fairway
