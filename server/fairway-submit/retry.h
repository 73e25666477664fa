#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/fairway-submit/http_session.h"

namespace fairway {

/// What an answer means for trying again.
enum class Worth {
  settled,      ///< it will not become another
  later,        ///< the server lives and cannot yet: 408, 409 (still in work), 429, 507
  unreachable,  ///< no server answered for itself: no connection, 502, 503, 504
};

Worth worth_of(const HttpAnswer& answer);

/// The pause that an answer asks for: Retry-After in seconds or as a date (RFC 9110). Nothing where
/// it says nothing readable.
std::optional<std::chrono::milliseconds> retry_after(const HttpAnswer& answer);

/// Pauses that double from 0.1 s to 10 s, each shortened by up to a half at random, so that clients
/// that failed together do not come back together.
class Backoff {
 public:
  /// `seed`: any number, another one for each of several clients.
  explicit Backoff(std::uint64_t seed) : state_(seed) {}

  /// The next pause; at least what `answer` asks for.
  std::chrono::milliseconds next(const HttpAnswer& answer);

 private:
  std::uint64_t state_;
  int tries_ = 0;
};

}  // namespace fairway
