#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/http/connection.h"
#include "server/fairwayd/http/http_engine.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/os/event_flag.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// An address to listen on.
struct ListenAddress {
  std::string host = "127.0.0.1";  ///< a name, an IPv4 or an IPv6 address (without brackets)
  std::uint16_t port = 8080;       ///< 0 = any free one
};

/// Parses "HOST:PORT" or "[IPV6]:PORT". Errors: usage.
Result<ListenAddress> parse_listen_address(std::string_view text);

/// "127.0.0.1:8080", "[::1]:8080".
std::string to_string(const ListenAddress& address);

/// A bound, listening TCP socket.
struct Listener {
  UniqueFd socket;
  ListenAddress address;     ///< with the port that was found
  bool is_loopback = false;  ///< nobody beyond this machine reaches it
};

/// Binds and listens. A port that somebody listens on already is refused, never shared.
/// Errors: conflict (taken), unavailable.
Result<Listener> listen_on(const ListenAddress& address);

/// Accepts connections and answers each in a thread of its own. Threads start when they are needed,
/// up to a cap; beyond it a connection is answered 503 at once.
class HttpServer {
 public:
  /// `application` and `log` must outlive the server. `stopping` ends all waits once raised.
  HttpServer(Listener listener, HttpApplication& application, const Log& log,
             const ConnectionLimits& limits, const EventFlag& stopping);
  /// Ends all threads; `stopping` has been raised before.
  ~HttpServer();

  void start();

 private:
  void accept_all();
  void tell_accepting(bool works, int error_number);
  void turn_one_away();
  void take(UniqueFd socket);
  void start_thread();
  void serve_queue(std::stop_token stop);

  const ConnectionLimits limits_;
  Listener listener_;
  HttpApplication& application_;
  const Log& log_;
  const EventFlag& stopping_;

  std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<UniqueFd> waiting_;
  std::size_t idle_ = 0;
  std::vector<std::jthread> threads_;

  bool accepts_ = true;
  UniqueFd reserve_;  ///< given up for a moment, to accept a client that is turned away
  std::jthread acceptor_;
};

}  // namespace fairway
