#include "server/fairwayd/webhooks/webhook_schedule.h"

#include <catch2/catch.hpp>

using namespace fairway;
using namespace std::chrono_literals;

namespace {

PostEnd answered(int status) {
  PostEnd end;
  end.status = status;
  return end;
}

PostEnd failed(PostFailure failure) {
  PostEnd end;
  end.failure = failure;
  return end;
}

}  // namespace

TEST_CASE("retries are those of Standard Webhooks, over three days, ten attempts in all") {
  std::chrono::milliseconds sum{0};
  int made = 1;
  for (; retry_delay(made, kFirstRetry, 0); ++made) sum += *retry_delay(made, kFirstRetry, 0);
  CHECK(made == kMaxWebhookAttempts);
  CHECK(retry_delay(1, kFirstRetry, 0) == 5s);
  CHECK(retry_delay(2, kFirstRetry, 0) == 5min);
  CHECK(retry_delay(9, kFirstRetry, 0) == 24h);
  CHECK(sum == 75h + 35min + 5s);
  CHECK_FALSE(retry_delay(0, kFirstRetry, 0));
}

TEST_CASE("jitter moves a delay by a fifth at most, the first delay stretches all") {
  CHECK(retry_delay(4, kFirstRetry, 1) == 144min);
  CHECK(retry_delay(4, kFirstRetry, -1) == 96min);
  CHECK(retry_delay(2, 1s, 0) == 1min);
  CHECK(retry_delay(9, 0s, 0.5) == 0s);
}

TEST_CASE("an answer of 2xx is delivered, 410 is the end, all else is tried again") {
  const auto state = [](const PostEnd& end, int made = 1) {
    return verdict_on(end, made, kFirstRetry, 0).state;
  };
  for (const int status : {200, 202, 204, 299}) {
    CHECK(state(answered(status)) == DeliveryState::delivered);
    CHECK(state(answered(status), kMaxWebhookAttempts) == DeliveryState::delivered);
  }
  CHECK(state(answered(410)) == DeliveryState::dead);
  for (const int status : {301, 302, 307, 400, 401, 404, 429, 500, 503}) {
    CAPTURE(status);
    CHECK(state(answered(status)) == DeliveryState::pending);
    CHECK(state(answered(status), kMaxWebhookAttempts - 1) == DeliveryState::pending);
    CHECK(state(answered(status), kMaxWebhookAttempts) == DeliveryState::dead);
  }
  CHECK(state(failed(PostFailure::unreachable)) == DeliveryState::pending);
  CHECK(state(failed(PostFailure::address_refused), kMaxWebhookAttempts) == DeliveryState::dead);
}

TEST_CASE("Retry-After of 429 and 503 is heeded, within a day, and never shortens a delay") {
  const auto delay = [](int status, std::chrono::seconds retry_after) {
    PostEnd end = answered(status);
    end.retry_after = retry_after;
    return verdict_on(end, 1, kFirstRetry, 0).delay;
  };
  CHECK(delay(429, 90s) == 90s);
  CHECK(delay(503, 90s) == 90s);
  CHECK(delay(503, 1s) == 5s);
  CHECK(delay(503, 1000h) == 24h);
  CHECK(delay(500, 90s) == 5s);
}
