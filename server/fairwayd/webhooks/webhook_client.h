#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// Why no answer came.
enum class PostFailure : std::uint8_t {
  none,
  address_refused,  ///< see WebhookClientOptions::allow_private
  unresolved,       ///< the host name has no address
  unreachable,      ///< no connection
  timed_out,
  untrusted,  ///< TLS did not come about, or the certificate is not good
  broken,     ///< what came is no HTTP answer
};

/// A sentence about a failure, for those who own the webhook.
std::string_view sentence_of(PostFailure failure);

struct WebhookPost {
  std::string url;
  NameValues headers;
  std::string body;
};

/// How a POST ended. A status that came counts, however the rest of the answer ends.
struct PostEnd {
  std::int64_t ticket = 0;
  std::optional<int> status;  ///< exactly if there was no failure
  PostFailure failure = PostFailure::none;
  std::optional<std::chrono::seconds> retry_after;  ///< what the answer asks for
  std::chrono::milliseconds took{0};
};

struct WebhookClientOptions {
  /// Connect to addresses that are not public, too. What is checked is the address that is
  /// connected to, so a name cannot mean another one a moment later.
  bool allow_private = false;
  std::chrono::milliseconds connect_timeout{10'000};  ///< resolving and TLS included
  std::chrono::milliseconds timeout{30'000};          ///< of all
};

/// Sends POSTs to servers that nobody vouches for, many at a time from one thread: http and https
/// only, certificates checked, no redirects, no proxy, no cookies, every POST on a connection of
/// its own, and next to nothing read of an answer. For use by one thread.
class WebhookClient {
 public:
  /// Errors: unavailable.
  static Result<std::unique_ptr<WebhookClient>> create(const WebhookClientOptions& options);
  WebhookClient(const WebhookClient&) = delete;
  WebhookClient& operator=(const WebhookClient&) = delete;
  /// Breaks off what is on its way.
  ~WebhookClient();

  /// Begins a POST; poll() tells its end under `ticket`. Errors: unavailable.
  Result<void> start(std::int64_t ticket, WebhookPost post);

  /// Moves all that is on its way on, for at most `time`, and returns what has ended.
  std::vector<PostEnd> poll(std::chrono::milliseconds time);

 private:
  struct Transfer;
  struct Library;

  explicit WebhookClient(const WebhookClientOptions& options);

  const WebhookClientOptions options_;
  std::unique_ptr<Library> library_;
};

}  // namespace fairway
