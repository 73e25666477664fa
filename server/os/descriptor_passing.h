#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// Most descriptors that travel with one message.
inline constexpr std::size_t kMostPassed = 4;

/// Sends all of `bytes`, at least one, over a stream socket of this machine (SCM_RIGHTS), and with
/// the first of them copies of `descriptors`. Errors: io (the other side is gone, or did not read
/// within SO_SNDTIMEO).
Result<void> send_with_descriptors(int socket, std::span<const char> bytes,
                                   std::span<const int> descriptors);

/// Bytes that came, with the descriptors that came with them, close-on-exec.
struct Passed {
  std::string bytes;  ///< empty: the other side has closed
  std::vector<UniqueFd> descriptors;
};

/// One read. Errors: io.
Result<Passed> receive_with_descriptors(int socket);

}  // namespace fairway
