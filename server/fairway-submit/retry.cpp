#include "server/fairway-submit/retry.h"

#include <algorithm>
#include <charconv>
#include <ctime>

namespace fairway {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kFirstPause{100};
constexpr milliseconds kLongestPause{10'000};
constexpr int kDoublings = 7;

/// "Sun, 06 Nov 1994 08:49:37 GMT", by the clock of this machine.
std::optional<milliseconds> until_date(const std::string& text) {
  std::tm date{};
  const char* end = ::strptime(text.c_str(), "%a, %d %b %Y %H:%M:%S GMT", &date);
  if (end == nullptr || *end != '\0') return std::nullopt;
  const std::time_t left = ::timegm(&date) - std::time(nullptr);
  return seconds(std::max<std::time_t>(left, 0));
}

}  // namespace

Worth worth_of(const HttpAnswer& answer) {
  switch (answer.status) {
    case 408:
    case 409:
    case 429:
    case 507:
      return Worth::later;
    case 502:
    case 503:
    case 504:
      return Worth::unreachable;
    case 0:
      return answer.lost == HttpAnswer::Lost::connection ? Worth::unreachable : Worth::settled;
    default:
      return Worth::settled;
  }
}

std::optional<milliseconds> retry_after(const HttpAnswer& answer) {
  const std::string text = answer.header("retry-after");
  std::uint32_t count = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (status == std::errc() && end == text.data() + text.size()) return seconds(count);
  return until_date(text);
}

milliseconds Backoff::next(const HttpAnswer& answer) {
  // Linear congruential generator of Knuth's MMIX: spread, not secrecy.
  state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
  const auto random = static_cast<std::int64_t>(state_ >> 54U);  // 0 … 1023
  const milliseconds full =
      std::min(kFirstPause * (1 << std::min(tries_, kDoublings)), kLongestPause);
  ++tries_;
  const milliseconds pause = full - full * random / 2048;
  const auto asked = retry_after(answer);
  return asked ? *asked + pause / 4 : pause;
}

}  // namespace fairway
