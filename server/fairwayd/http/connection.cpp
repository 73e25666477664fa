#include "server/fairwayd/http/connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kReceive = 64 * 1024;
constexpr std::size_t kMaxChunkLine = 256;
constexpr std::size_t kMaxTrailers = 16;
constexpr int kMaxEmptyLines = 8;
constexpr milliseconds kLastWord{100};
/// For a client to read what is being answered when the server stops.
constexpr milliseconds kReadOut{5000};
/// Of chunk sizes and extensions, beyond as much as the content.
constexpr std::uint64_t kMaxChunkOverhead = std::uint64_t{1} << 20;
constexpr std::uint64_t kLingerBytes = std::uint64_t{4} << 20;

Error bad(std::string message) {
  return {ErrorCode::bad_request, std::move(message)};
}

Error too_large() {
  return {ErrorCode::too_large, "The body is larger than this server takes: send a smaller one."};
}

/// False where no method begins like this: a TLS client on this plain port, for one.
bool may_begin_request(std::string_view bytes) {
  return bytes.empty() || bytes.front() == '\r' || is_token(bytes.substr(0, 1));
}

/// `line_size`: of the request line, as found.
Error endless_head(std::size_t line_size) {
  if (line_size > kMaxHeadLine) {
    return {ErrorCode::uri_too_long, "The request line does not end: send a shorter one."};
  }
  return {ErrorCode::headers_too_large,
          fmt::format("The request head is longer than {} bytes.", kMaxHeadBytes)};
}

}  // namespace

Connection::Connection(UniqueFd socket, const ConnectionLimits& limits, int stop_descriptor)
    : socket_(std::move(socket)),
      limits_(limits),
      stop_descriptor_(stop_descriptor),
      pace_(limits.least_rate) {}

/// `stop_descriptor`: what ends the wait; -1: nothing.
Connection::Wait Connection::wait_for(short events, Clock::time_point until,
                                      int stop_descriptor) const {
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
    std::array<pollfd, 2> entries{{{socket_.get(), events, 0}, {stop_descriptor, POLLIN, 0}}};
    const auto timeout = static_cast<int>(std::max(left, milliseconds(0)).count());
    const int ready = ::poll(entries.data(), entries.size(), timeout);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return Wait::timeout;
    if (entries[0].revents != 0) return Wait::ready;
    return Wait::stopped;
  }
}

/// As wait_for(), at the client's expense.
Connection::Wait Connection::await(ClientPhase phase, Clock::duration patience,
                                   Clock::time_point until) {
  auto worn_out = pace_.begin(phase, patience, Clock::now());
  // Evicted between two waits: only a last word is left to say.
  if (evicted_) worn_out = std::min(worn_out, Clock::now() + kLastWord);
  const short events = phase == ClientPhase::answer ? POLLOUT : POLLIN;
  Wait waited = wait_for(events, std::min(worn_out, until), stop_descriptor_);
  if (waited == Wait::stopped && phase == ClientPhase::answer) {
    if (!read_out_) read_out_ = Clock::now() + kReadOut;
    waited = wait_for(events, std::min(worn_out, *read_out_), -1);
  }
  pace_.end(Clock::now());
  return waited;
}

/// True: something came. False: the client closed.
Result<bool> Connection::receive(ClientPhase phase, Clock::duration patience,
                                 Clock::time_point until) {
  const Wait waited = await(phase, patience, until);
  if (evicted_) {
    return Error{
        ErrorCode::unavailable,
        "The server has more clients than it can serve, and this one was slow: try later."};
  }
  if (waited == Wait::timeout) {
    return Error{ErrorCode::request_timeout, "The request came too slowly: send it again."};
  }
  if (waited == Wait::stopped) return Error{ErrorCode::unavailable, "The server is stopping."};
  if (stopped_receiving_) return false;
  buffer_.erase(0, at_);
  at_ = 0;
  const std::size_t had = buffer_.size();
  buffer_.resize(had + kReceive);
  const ssize_t got = ::recv(socket_.get(), buffer_.data() + had, kReceive, 0);
  buffer_.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  received_ += buffer_.size() - had;
  return got > 0;
}

Result<bool> Connection::receive_body() {
  // Who sends without a pause is never waited for.
  if (Clock::now() >= body_until_) {
    return Error{ErrorCode::request_timeout, "The body took too long: send it faster."};
  }
  const std::uint64_t before = received_;
  auto got = receive(ClientPhase::body, limits_.stall, body_until_);
  if (got) pace_.excuse(static_cast<std::size_t>(received_ - before));
  return got;
}

Result<std::optional<RequestHead>> Connection::read_head() {
  bool started = at_ < buffer_.size();
  int empty_lines = 0;
  pace_.restart();
  while (true) {
    // An empty line before a request is allowed to be ignored.
    while (std::string_view(buffer_).substr(at_).starts_with("\r\n")) {
      if (++empty_lines > kMaxEmptyLines) return bad("There is no request between empty lines.");
      at_ += 2;
    }
    if (!may_begin_request(std::string_view(buffer_).substr(at_))) {
      return bad("This is not HTTP: the first byte cannot begin a request.");
    }
    const std::size_t end = buffer_.find("\r\n\r\n", at_);
    if (end != std::string::npos && end - at_ <= kMaxHeadBytes) {
      auto head = parse_request_head(std::string_view(buffer_).substr(at_, end + 4 - at_));
      if (!head) return head.error();
      at_ = end + 4;
      framing_ = head->framing;
      left_ = framing_.length.value_or(0);
      taken_ = chunk_overhead_ = 0;
      first_chunk_ = true;
      body_over_ = !framing_.has_body();
      owes_continue_ = head->expects_continue;
      body_until_ = Clock::now() + limits_.body;
      pace_.restart();
      return std::optional(std::move(*head));
    }
    if (buffer_.size() - at_ > kMaxHeadBytes) {
      return endless_head(std::string_view(buffer_).substr(at_).find("\r\n"));
    }
    auto got = receive(started ? ClientPhase::head : ClientPhase::idle,
                       started ? limits_.head : limits_.idle);
    const bool begun = at_ < buffer_.size();
    if (!got && (!begun || (got.error().code == ErrorCode::unavailable && !evicted_))) {
      return std::optional<RequestHead>();
    }
    if (!got) return got.error();
    if (!*got && begun) return bad("The request head is cut short.");
    if (!*got) return std::optional<RequestHead>();
    if (!started) pace_.restart();
    started = true;
  }
}

Result<std::size_t> Connection::read_body(std::span<char> space) {
  if (body_over_) return std::size_t{0};
  if (owes_continue_) {
    owes_continue_ = false;
    if (!send("HTTP/1.1 100 Continue\r\n\r\n")) return bad("The client is gone.");
  }
  if (framing_.chunked && left_ == 0) {
    auto more = start_chunk();
    if (!more) return more.error();
    if (!*more) return std::size_t{0};
  }
  if (at_ == buffer_.size()) {
    auto got = receive_body();
    if (!got) return got.error();
    if (!*got) return bad("The body ends before its length.");
  }
  const std::size_t count =
      std::min({space.size(), buffer_.size() - at_, static_cast<std::size_t>(left_)});
  if (count > limits_.body_bytes - taken_) return too_large();
  std::memcpy(space.data(), buffer_.data() + at_, count);
  at_ += count;
  left_ -= count;
  taken_ += count;
  if (!framing_.chunked && left_ == 0) body_over_ = true;
  return count;
}

Result<std::optional<std::string>> Connection::take_line(std::size_t limit) {
  while (true) {
    const std::size_t end = buffer_.find("\r\n", at_);
    if (end != std::string::npos && end - at_ <= limit) {
      std::string line = buffer_.substr(at_, end - at_);
      at_ = end + 2;
      chunk_overhead_ += line.size() + 2;
      return std::optional(std::move(line));
    }
    if (buffer_.size() - at_ > limit + 1) return std::optional<std::string>();
    auto got = receive_body();
    if (!got) return got.error();
    if (!*got) return bad("The body ends inside a chunk.");
  }
}

/// Reads the line before a chunk (and the line end after the one before). False: that was the last.
Result<bool> Connection::start_chunk() {
  if (!first_chunk_) {
    auto end = take_line(0);
    if (!end) return end.error();
    if (!*end) return bad("A chunk does not end where its size says.");
  }
  first_chunk_ = false;
  auto line = take_line(kMaxChunkLine);
  if (!line) return line.error();
  if (!*line) return bad("A chunk's size line is too long.");
  const std::string_view size = std::string_view(**line).substr(0, (*line)->find_first_of("; \t"));
  const auto [stop, status] = std::from_chars(size.data(), size.data() + size.size(), left_, 16);
  if (size.empty() || size.front() == '-' || status != std::errc() ||
      stop != size.data() + size.size()) {
    return bad("A chunk's size is not a hexadecimal number of reasonable size.");
  }
  if (left_ == 0) return end_chunks();
  if (left_ > limits_.body_bytes - taken_) return too_large();
  if (chunk_overhead_ > taken_ + kMaxChunkOverhead) return bad("The chunks are too small.");
  return true;
}

/// Skips the trailers.
Result<bool> Connection::end_chunks() {
  for (std::size_t i = 0; i <= kMaxTrailers; ++i) {
    auto line = take_line(kMaxHeadLine);
    if (!line) return line.error();
    if (!*line) break;
    if ((*line)->empty()) {
      body_over_ = true;
      return false;
    }
  }
  return bad("The trailers of the body are too long.");
}

bool Connection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    // While the server stops, a client that reads still gets its answer; one that reads for long,
    // or does not, is left.
    if (await(ClientPhase::answer, limits_.stall) != Wait::ready) return false;
    const ssize_t sent =
        ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
    sent_ += static_cast<std::uint64_t>(sent);
    pace_.excuse(static_cast<std::size_t>(sent));
  }
  return true;
}

bool Connection::client_is_there() const {
  pollfd entry{socket_.get(), POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) == 0;
}

void Connection::stop_receiving() {
  stopped_receiving_ = true;
  ::shutdown(socket_.get(), SHUT_RD);  // ends a wait
}

void Connection::evict() {
  evicted_ = true;
  // A wait for a reader ends only once both ways are shut.
  const bool reads_answer = waiting(Clock::now()).phase == ClientPhase::answer;
  ::shutdown(socket_.get(), reads_answer ? SHUT_RDWR : SHUT_RD);
}

void Connection::finish_refused() {
  ::shutdown(socket_.get(), SHUT_WR);
  pace_.restart();
  std::array<char, 16384> waste;
  std::uint64_t wasted = 0;
  while (wasted < kLingerBytes && await(ClientPhase::idle, limits_.linger) == Wait::ready) {
    const ssize_t got = ::recv(socket_.get(), waste.data(), waste.size(), MSG_DONTWAIT);
    if (got <= 0) return;
    wasted += static_cast<std::uint64_t>(got);
  }
}

}  // namespace fairway
