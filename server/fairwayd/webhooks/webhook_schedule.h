#pragma once

#include <chrono>
#include <optional>

#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/webhooks/webhook_client.h"

namespace fairway {

/// So many attempts are made, over three days.
inline constexpr int kMaxWebhookAttempts = 10;

/// The first delay of the schedule of Standard Webhooks: 5 s, 5 min, 30 min, 2 h, 5 h, 10 h, 14 h,
/// 20 h, 24 h.
inline constexpr std::chrono::seconds kFirstRetry{5};

/// How long to wait after the `made`-th attempt (from 1) before the next; nothing after the last.
/// `first` stands in for kFirstRetry and stretches all delays alike. `jitter`, −1 … 1, moves it by
/// up to a fifth, so that what failed together does not come back together.
std::optional<std::chrono::milliseconds> retry_delay(int made, std::chrono::milliseconds first,
                                                     double jitter);

struct Verdict {
  DeliveryState state = DeliveryState::pending;
  std::chrono::milliseconds delay{0};  ///< of the next attempt, where it stays pending
};

/// What an attempt means: 2xx is delivered; 410 and the end of the schedule are the end; anything
/// else is tried again, no sooner than a 429 or 503 asks for with Retry-After (up to a day).
Verdict verdict_on(const PostEnd& end, int made, std::chrono::milliseconds first, double jitter);

}  // namespace fairway
