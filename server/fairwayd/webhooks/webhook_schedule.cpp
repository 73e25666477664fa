#include "server/fairwayd/webhooks/webhook_schedule.h"

#include <algorithm>
#include <array>

namespace fairway {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr std::array<seconds, kMaxWebhookAttempts - 1> kDelays = {
    kFirstRetry, minutes(5), minutes(30), hours(2),  hours(5),
    hours(10),   hours(14),  hours(20),   hours(24),
};
constexpr double kJitter = 0.2;
constexpr milliseconds kLongestRetryAfter = hours(24);

constexpr int kGone = 410;
constexpr int kTooManyRequests = 429;
constexpr int kUnavailable = 503;

}  // namespace

std::optional<milliseconds> retry_delay(int made, milliseconds first, double jitter) {
  if (made < 1 || made >= kMaxWebhookAttempts) return std::nullopt;
  const double steps = static_cast<double>(kDelays.at(static_cast<std::size_t>(made - 1)).count()) /
                       static_cast<double>(kFirstRetry.count());
  const double delay = static_cast<double>(first.count()) * steps * (1.0 + kJitter * jitter);
  return milliseconds(static_cast<milliseconds::rep>(delay));
}

Verdict verdict_on(const PostEnd& end, int made, milliseconds first, double jitter) {
  const int status = end.status.value_or(0);
  if (status >= 200 && status < 300) return {DeliveryState::delivered, {}};
  const auto delay = retry_delay(made, first, jitter);
  if (status == kGone || !delay) return {DeliveryState::dead, {}};
  milliseconds wait = *delay;
  if ((status == kTooManyRequests || status == kUnavailable) && end.retry_after) {
    wait = std::max(wait, std::min<milliseconds>(*end.retry_after, kLongestRetryAfter));
  }
  return {DeliveryState::pending, wait};
}

}  // namespace fairway
