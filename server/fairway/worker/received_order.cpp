// The one message that a worker gets.

#include "server/fairway/worker/received_order.h"

#include <utility>

#include "proto/messages/worker_protocol.h"
#include "server/os/descriptor_passing.h"

namespace fairway {

Result<ReceivedOrder> receive_order(int socket) {
  ReceivedOrder order;
  while (!order.line.ends_with('\n')) {
    Result<Passed> passed = receive_with_descriptors(socket);
    if (!passed || passed->bytes.empty()) {
      return Error{ErrorCode::canceled, "The server is gone."};
    }
    if (passed->descriptors.size() == 2) {
      order.input = std::move(passed->descriptors[0]);
      order.output = std::move(passed->descriptors[1]);
    }
    order.line += passed->bytes;
    if (order.line.size() > kMaxWorkerLine) {
      return Error{ErrorCode::malformed_input, "The order is longer than a line may be."};
    }
  }
  order.line.pop_back();
  if (!order.input || !order.output) {
    return Error{ErrorCode::malformed_input, "The order came without its files."};
  }
  return order;
}

}  // namespace fairway
