#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/http/connection.h"
#include "server/fairwayd/http/connection_roster.h"
#include "server/fairwayd/http/http_engine.h"
#include "server/fairwayd/http/waiting_room.h"
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

/// How many connections a server serves at a time.
struct ServerCapacity {
  std::size_t connections = 512;
  std::size_t vital = 4;  ///< threads beside them, for one vital request at a time
};

/// Accepts connections and answers each in a thread of its own. Threads start when they are needed,
/// up to a cap. Beyond it a new connection waits until it has asked (WaitingRoom): what is vital is
/// answered, and for all else the slowest connection gives way (ConnectionRoster). Where none is
/// slow it is refused (503).
class HttpServer {
 public:
  /// `application` and `log` must outlive the server. `stopping` ends all waits once raised.
  HttpServer(Listener listener, HttpApplication& application, const Log& log,
             const ConnectionLimits& limits, const EventFlag& stopping,
             const ServerCapacity& capacity = {});
  /// Ends all threads; `stopping` has been raised before.
  ~HttpServer();

  void start();

 private:
  /// Threads that take connections from one queue.
  struct Lane {
    std::condition_variable_any arrived;
    std::deque<Visitor> waiting;
    std::size_t open = 0;  ///< taken and not yet ended
    std::size_t idle = 0;  ///< threads that wait
    std::vector<std::jthread> threads;
  };

  void accept_all();
  void tell_accepting(bool works, int error_number);
  void turn_one_away();
  void take(Visitor arrival);
  void tell_full();
  bool admit(Visitor& visitor, std::string_view method, std::string_view path);
  void enter(Lane& lane, Visitor arrival);
  void start_thread(Lane& lane);
  void serve_queue(Lane& lane, const std::stop_token& stop);

  const ConnectionLimits limits_;
  const ServerCapacity capacity_;
  Listener listener_;
  HttpApplication& application_;
  const Log& log_;
  const EventFlag& stopping_;
  ConnectionRoster roster_;

  std::mutex mutex_;
  Lane lane_;   ///< guarded by mutex_
  Lane vital_;  ///< guarded by mutex_

  // Of the accepting thread, once it runs.
  std::unique_ptr<WaitingRoom> waiting_room_;  ///< none: it could not be made
  std::optional<std::chrono::steady_clock::time_point> told_full_;
  bool accepts_ = true;
  UniqueFd reserve_;  ///< given up for a moment, to accept a client that is turned away
  std::jthread acceptor_;
};

}  // namespace fairway
