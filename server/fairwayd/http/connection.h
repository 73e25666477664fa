#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "server/fairwayd/http/client_pace.h"
#include "server/fairwayd/http/http_head.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// Time and size that a connection may take.
struct ConnectionLimits {
  std::chrono::milliseconds idle{5000};   ///< between two requests
  std::chrono::milliseconds head{10000};  ///< for a whole request head
  /// Of waiting for bytes of a body, or for an answer to be read, that no bytes excuse.
  std::chrono::milliseconds stall{15000};
  std::uint64_t least_rate = 1024;         ///< bytes that excuse a second of the stall
  std::chrono::milliseconds body{600000};  ///< for a whole body
  /// For what a client still sends after its refusal, so that it gets to read the answer.
  std::chrono::milliseconds linger{1000};
  std::uint64_t body_bytes = 0;  ///< of any body, framing not counted
};

/// A client's socket as a sequence of requests: heads that are checked, and bodies that end where
/// their framing says. For one thread,
/// but for what says otherwise.
class Connection {
 public:
  /// Waits end early once `stop_descriptor` is readable.
  Connection(UniqueFd socket, const ConnectionLimits& limits, int stop_descriptor);

  /// The next request's head. Nothing: the client is gone or idle, or the server stops.
  /// Errors: bad_request, uri_too_long, headers_too_large, request_timeout, unavailable (evicted).
  Result<std::optional<RequestHead>> read_head();

  /// Bytes of the current body, at most `space.size()`; 0 at its end. The first call tells a client
  /// that expects it to continue, so that a refusal without reading comes before the upload.
  /// Errors: bad_request (cut short, badly framed), too_large, request_timeout, unavailable (the
  /// server stops, or the client is evicted).
  Result<std::size_t> read_body(std::span<char> space);

  /// True once the whole body of the current request has been read, so that a next one may follow.
  bool body_is_over() const { return body_over_; }

  /// Sends all of it. False: the client is gone or does not read.
  bool send(std::string_view bytes);

  /// False once the client has closed its sending side, which is taken as hanging up.
  bool client_is_there() const;

  /// Nothing more comes from the client, as if it had closed its sending side. From any thread.
  void stop_receiving();

  /// The client loses its connection to somebody else: waits end, what is awaited counts as
  /// unavailable. From any thread.
  void evict();
  /// What the client is waited for, and how long. From any thread.
  ClientPace::Waiting waiting(std::chrono::steady_clock::time_point now) const {
    return pace_.waiting(now);
  }

  /// Ends the answer, and reads on for a moment what the client may still be sending, so that the
  /// answer is not lost to a reset.
  void finish_refused();

  int descriptor() const { return socket_.get(); }

  /// On the wire since the connection began; received: what has been consumed of it.
  std::uint64_t bytes_received() const { return received_ - (buffer_.size() - at_); }
  std::uint64_t bytes_sent() const { return sent_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Wait { ready, timeout, stopped };

  Wait wait_for(short events, Clock::time_point until, int stop_descriptor) const;
  Wait await(ClientPhase phase, Clock::duration patience,
             Clock::time_point until = Clock::time_point::max());
  Result<bool> receive(ClientPhase phase, Clock::duration patience,
                       Clock::time_point until = Clock::time_point::max());
  Result<bool> receive_body();
  Result<std::optional<std::string>> take_line(std::size_t limit);
  Result<bool> start_chunk();
  Result<bool> end_chunks();

  UniqueFd socket_;
  ConnectionLimits limits_;
  int stop_descriptor_;
  std::string buffer_;  ///< received, not yet consumed
  std::size_t at_ = 0;  ///< the consumed part of buffer_
  Framing framing_;
  std::uint64_t left_ = 0;  ///< of the body, or of the current chunk
  std::uint64_t taken_ = 0;
  std::uint64_t chunk_overhead_ = 0;
  bool first_chunk_ = true;
  bool owes_continue_ = false;  ///< the client waits for "100 Continue" before it sends the body
  bool body_over_ = true;
  Clock::time_point body_until_;
  std::optional<Clock::time_point> read_out_;  ///< the end of an answer in a server that stops
  ClientPace pace_;
  std::atomic<bool> stopped_receiving_ = false;
  std::atomic<bool> evicted_ = false;
  std::uint64_t received_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace fairway
