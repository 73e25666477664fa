#include "server/fairway-submit/server_client.h"

#include <condition_variable>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "server/fairway-submit/retry.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr int kNotModified = 304;
/// Hiccups shorter than so many tries are not worth a word.
constexpr int kSilentTries = 2;
/// A long poll that came back sooner than this, with nothing new, was not allowed to wait.
constexpr milliseconds kShortWait{1000};
constexpr milliseconds kPollPause{300};

std::string trouble_of(const HttpAnswer& answer) {
  return answer.status == 0 ? answer.reason : fmt::format("it answers {}", answer.status);
}

}  // namespace

ServerClient::ServerClient(const ClientSettings& settings, ProgressDisplay& progress,
                           std::stop_token stop, std::uint64_t seed)
    : session_(settings.http),
      settings_(settings),
      progress_(progress),
      stop_(std::move(stop)),
      seed_(seed) {}

Exchange ServerClient::submit(const Payload& payload, const std::string& idempotency_key) {
  std::string path = "/v1/jobs" + payload.query();
  for (const std::string& label : settings_.labels) {
    path += fmt::format("{}label={}", path.find('?') == std::string::npos ? '?' : '&',
                        url_encoded(label));
  }
  return persist([&] {
    return session_.post(path, {{"Idempotency-Key", idempotency_key}}, payload);
  });
}

Exchange ServerClient::job(const std::string& id, const std::string& etag) {
  HttpSession::Headers headers;
  if (!etag.empty()) headers = {{"If-None-Match", etag}, {"Prefer", "wait=30"}};
  const auto begin = Clock::now();
  Exchange exchange = persist([&] { return session_.get("/v1/jobs/" + id, headers); });
  const bool same =
      exchange.answer.status == kNotModified || exchange.answer.header("etag") == etag;
  if (same && Clock::now() - begin < kShortWait && !pause(kPollPause)) {
    exchange.ending = Ending::stopped;
  }
  return exchange;
}

Exchange ServerClient::result(const std::string& id, const std::function<bool()>& begin,
                              const HttpSession::Receiver& receive,
                              const std::function<std::string(const HttpAnswer&)>& check) {
  return persist([&] {
    if (!begin()) return HttpAnswer{.lost = HttpAnswer::Lost::by_receiver};
    HttpAnswer answer = session_.get(fmt::format("/v1/jobs/{}/result", id), {}, receive);
    if (answer.status != 200) return answer;
    if (std::string wrong = check(answer); !wrong.empty()) {
      return HttpAnswer{.lost = HttpAnswer::Lost::connection, .reason = std::move(wrong)};
    }
    return answer;
  });
}

/// Tries again until the answer is settled, the limit is over or the batch ends.
Exchange ServerClient::persist(const std::function<HttpAnswer()>& request) {
  Backoff backoff(seed_ ^ static_cast<std::uint64_t>(Clock::now().time_since_epoch().count()));
  const auto until = Clock::now() + settings_.retry_for;
  for (int tries = 1;; ++tries) {
    if (stop_.stop_requested()) return {Ending::stopped, {}};
    HttpAnswer answer = request();
    const Worth worth = worth_of(answer);
    if (worth != Worth::unreachable) progress_.server_answers();
    if (worth == Worth::settled) return {Ending::answered, std::move(answer)};
    if (stop_.stop_requested()) return {Ending::stopped, {}};
    const milliseconds time = backoff.next(answer);
    if (Clock::now() + time > until) {
      // A server that answers others but breaks this one off is there.
      const bool there =
          worth == Worth::later || (answer.status == 0 && session_.get("/livez", {}).status == 200);
      return {there ? Ending::gave_up : Ending::no_server, std::move(answer)};
    }
    if (worth == Worth::unreachable && tries > kSilentTries) {
      progress_.server_missing(trouble_of(answer));
    }
    if (!pause(time)) return {Ending::stopped, std::move(answer)};
  }
}

/// False: the batch ends.
bool ServerClient::pause(milliseconds time) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any changed;
  changed.wait_for(lock, stop_, time, [] { return false; });
  return !stop_.stop_requested();
}

}  // namespace fairway
