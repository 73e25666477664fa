#include "server/fairwayd/api/rate_limit.h"

#include <algorithm>
#include <cmath>

namespace fairway {

RateLimit::Verdict RateLimit::take(const std::string& tenant, Clock::time_point now) {
  if (!is_on()) return {};
  const auto full = static_cast<double>(per_minute_);
  const double per_second = full / 60.0;
  const std::lock_guard lock(mutex_);
  Bucket& bucket = buckets_.try_emplace(tenant, Bucket{full, now}).first->second;
  const double passed = std::chrono::duration<double>(now - bucket.at).count();
  bucket.level = std::min(full, bucket.level + std::max(passed, 0.0) * per_second);
  bucket.at = now;
  Verdict verdict;
  verdict.allowed = bucket.level >= 1;
  if (verdict.allowed) bucket.level -= 1;
  verdict.left = static_cast<std::uint64_t>(bucket.level);
  const double missing = std::floor(bucket.level) + 1 - bucket.level;
  verdict.reset = std::chrono::seconds(
      std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(missing / per_second))));
  return verdict;
}

}  // namespace fairway
