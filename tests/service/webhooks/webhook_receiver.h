#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/os/unique_fd.h"

namespace fairway::test {

/// A POST that a webhook received.
struct Received {
  std::string target;                          ///< path and query
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;

  const std::string& id() const { return headers.at("webhook-id"); }
};

/// The status line and headers of an answer, without a body.
std::string answer_of(int status, const std::string& headers = {});

/// Holds answers back until it is opened.
class Latch {
 public:
  /// Opens it at the end of a scope, so that a failed test does not hang. Stands behind the
  /// receiver whose answers wait.
  class OpenedAtEnd {
   public:
    explicit OpenedAtEnd(Latch& latch) : latch_(latch) {}
    OpenedAtEnd(const OpenedAtEnd&) = delete;
    OpenedAtEnd& operator=(const OpenedAtEnd&) = delete;
    ~OpenedAtEnd() { latch_.open(); }

   private:
    Latch& latch_;
  };

  void open();
  void wait();

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool is_open_ = false;
};

/// An HTTP server on a port of the loopback that is its own from the beginning, and takes
/// connections from open() on. Every request is kept; `answer` makes the whole answer of the n-th
/// (from 0), in a thread of its own. An empty one hangs up.
class WebhookReceiver {
 public:
  using Answer = std::function<std::string(const Received& post, std::size_t n)>;

  explicit WebhookReceiver(Answer answer = [](const Received&, std::size_t) {
    return answer_of(204);
  });
  WebhookReceiver(const WebhookReceiver&) = delete;
  WebhookReceiver& operator=(const WebhookReceiver&) = delete;
  /// Hangs up on all who wait; an answer that is being made must come to its end.
  ~WebhookReceiver();

  void open();
  std::string url(const std::string& path = "/hook", const std::string& host = "127.0.0.1") const;
  std::uint16_t port() const { return port_; }

  /// Waits until there are so many, and returns all; fails the test after a long while.
  std::vector<Received> wait_for(std::size_t count);

 private:
  void serve();
  void answer_one(int connection);

  const Answer answer_;
  UniqueFd socket_;
  std::uint16_t port_ = 0;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Received> received_;
  std::vector<std::thread> threads_;
  std::thread acceptor_;
};

/// Keeps the first one waiting until the latch is opened, and then says nothing; 200 to all others.
inline WebhookReceiver::Answer first_one_waits(Latch& latch) {
  return [&latch](const Received&, std::size_t n) {
    if (n > 0) return answer_of(200);
    latch.wait();
    return std::string();
  };
}

}  // namespace fairway::test
