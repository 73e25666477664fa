#include "server/fairwayd/http/connection.h"

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <sys/socket.h>

#include "server/os/child_process.h"
#include "server/os/event_flag.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

/// A client's end, and the connection that serves it.
class Fixture {
 public:
  explicit Fixture(ConnectionLimits limits = quick()) : limits_(limits) {
    auto ends = socket_pair();
    REQUIRE(ends);
    client_ = std::move(ends->first);
    auto flag = EventFlag::create();
    REQUIRE(flag);
    stop_ = std::make_unique<EventFlag>(std::move(*flag));
    connection_ =
        std::make_unique<Connection>(std::move(ends->second), limits_, stop_->descriptor());
  }
  static ConnectionLimits quick() {
    ConnectionLimits limits;
    limits.idle = limits.head = limits.stall = 50ms;
    limits.body_bytes = 1000;
    return limits;
  }

  void send(std::string_view text) {
    REQUIRE(::send(client_.get(), text.data(), text.size(), 0) ==
            static_cast<ssize_t>(text.size()));
  }
  void send_what_is_taken(std::string_view text) {
    ::send(client_.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }
  void close_sending() { ::shutdown(client_.get(), SHUT_WR); }
  std::string answer() {
    std::array<char, 200> space{};
    const ssize_t got = ::recv(client_.get(), space.data(), space.size(), MSG_DONTWAIT);
    return got > 0 ? std::string(space.data(), static_cast<std::size_t>(got)) : "";
  }
  Connection& connection() { return *connection_; }
  const EventFlag& stop() const { return *stop_; }

  void begin(const std::string& framing) {
    send("POST / HTTP/1.1\r\n" + framing + "\r\n");
    auto head = connection().read_head();
    REQUIRE(head);
    REQUIRE(*head);
  }
  Result<std::string> body() {
    std::string text;
    std::array<char, 7> space{};
    while (true) {
      auto got = connection().read_body(space);
      if (!got) return got.error();
      if (*got == 0) return text;
      text.append(space.data(), *got);
    }
  }

 private:
  ConnectionLimits limits_;
  UniqueFd client_;
  std::unique_ptr<EventFlag> stop_;
  std::unique_ptr<Connection> connection_;
};

ErrorCode refusal(Fixture& f, const std::string& framing, const std::string& sent) {
  f.begin(framing);
  f.send(sent);
  f.close_sending();
  const auto body = f.body();
  REQUIRE_FALSE(body);
  CHECK_FALSE(f.connection().body_is_over());
  return body.error().code;
}

const std::string kChunked = "Transfer-Encoding: chunked\r\n";

}  // namespace

TEST_CASE("a body ends at its length and the next request begins there") {
  Fixture f;
  f.send("POST / HTTP/1.1\r\nContent-Length: 10\r\n\r\n0123456789GET / HTTP/1.1\r\n\r\n");
  REQUIRE(f.connection().read_head());
  CHECK(*f.body() == "0123456789");
  CHECK(f.connection().body_is_over());
  const auto next = f.connection().read_head();
  REQUIRE(next);
  REQUIRE(*next);
  CHECK((*next)->text == "GET / HTTP/1.1\r\n\r\n");
}

TEST_CASE("a chunked body is its chunks, without extensions and trailers") {
  Fixture f;
  f.begin(kChunked);
  f.send("5\r\nabcde\r\nA;x=y\r\n0123456789\r\n0\r\nTrailer: x\r\n\r\nGET / HTTP/1.1\r\n\r\n");
  CHECK(*f.body() == "abcde0123456789");
  CHECK(f.connection().body_is_over());
  REQUIRE(f.connection().read_head());
}

TEST_CASE("a body that is cut short is refused") {
  for (const char* sent : {"", "5", "5\r\nabc", "5\r\nabcde", "5\r\nabcde\r\n0\r\n"}) {
    CAPTURE(sent);
    Fixture f;
    CHECK(refusal(f, kChunked, sent) == ErrorCode::bad_request);
  }
  Fixture f;
  CHECK(refusal(f, "Content-Length: 5\r\n", "abc") == ErrorCode::bad_request);
}

TEST_CASE("a broken chunk is refused") {
  for (const char* sent : {"-2\r\nab\r\n", "zz\r\nab\r\n", "\r\nab\r\n", "2\r\nabc\r\n0\r\n\r\n",
                           "+2\r\nab\r\n", "0x2\r\nab\r\n", "11111111111111111\r\nab\r\n"}) {
    CAPTURE(sent);
    Fixture f;
    CHECK(refusal(f, kChunked, sent) == ErrorCode::bad_request);
  }
  Fixture f;
  CHECK(refusal(f, kChunked, std::string(1000, '1')) == ErrorCode::bad_request);
}

TEST_CASE("a body above the limit is refused, as soon as it is known") {
  Fixture counted;
  CHECK(refusal(counted, "Content-Length: 5000\r\n", std::string(2000, 'x')) ==
        ErrorCode::too_large);
  Fixture announced;
  CHECK(refusal(announced, kChunked, "ffffffffffffffff\r\n") == ErrorCode::too_large);
  std::string many;
  for (int i = 0; i < 300; ++i) many += "4\r\nabcd\r\n";
  Fixture summed;
  CHECK(refusal(summed, kChunked, many) == ErrorCode::too_large);
}

TEST_CASE("a client that expects it is told to continue when the body is wanted, not before") {
  Fixture f;
  f.begin("Content-Length: 3\r\nExpect: 100-continue\r\n");
  CHECK(f.answer().empty());
  f.send("abc");
  CHECK(*f.body() == "abc");
  CHECK(f.answer() == "HTTP/1.1 100 Continue\r\n\r\n");
}

TEST_CASE("slow clients meet a deadline") {
  Fixture idle;
  const auto nothing = idle.connection().read_head();
  REQUIRE(nothing);
  CHECK_FALSE(*nothing);
  Fixture slow_head;
  slow_head.send("GET / HT");
  const auto late = slow_head.connection().read_head();
  REQUIRE_FALSE(late);
  CHECK(late.error().code == ErrorCode::request_timeout);
  Fixture slow_body;
  slow_body.begin("Content-Length: 3\r\n");
  const auto body = slow_body.body();
  REQUIRE_FALSE(body);
  CHECK(body.error().code == ErrorCode::request_timeout);
}

TEST_CASE("a client that drips runs out of patience, one above the least rate does not") {
  ConnectionLimits limits = Fixture::quick();
  limits.stall = 300ms;
  limits.least_rate = 100;
  const auto refusal_of = [&](std::size_t drop) {
    Fixture f(limits);
    f.begin("Content-Length: 1000\r\n");
    std::array<char, 100> space{};
    // Waits come to 1 s at the most: ten drops that come at once, each after a wait of 100 ms.
    for (int i = 0; i < 10; ++i) {
      std::jthread sender([&] {
        std::this_thread::sleep_for(100ms);
        f.send(std::string(drop, 'x'));
      });
      const auto got = f.connection().read_body(space);
      if (!got) return std::optional(got.error().code);
    }
    return std::optional<ErrorCode>();
  };
  CHECK(refusal_of(1) == ErrorCode::request_timeout);
  CHECK_FALSE(refusal_of(100));
}

TEST_CASE("a client that reads by drops is left") {
  ConnectionLimits limits = Fixture::quick();
  limits.stall = 1s;  // longer than any one wait for the reader
  limits.least_rate = 4 << 20;
  Fixture f(limits);
  std::jthread reader([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (int i = 0; i < 20; ++i) f.answer();  // 4000 bytes
      std::this_thread::sleep_for(4ms);
    }
  });
  CHECK_FALSE(f.connection().send(std::string(8 << 20, 'x')));
}

TEST_CASE("chunks that are all frame, endless empty lines and what is no HTTP are refused") {
  ConnectionLimits limits = Fixture::quick();
  limits.body_bytes = 1 << 30;
  limits.stall = 60s;
  Fixture crumbs(limits);
  crumbs.begin(kChunked);
  std::jthread sender([&] {
    std::string many;
    for (int i = 0; i < 1000; ++i) many += "1;" + std::string(200, 'e') + "\r\nx\r\n";
    for (int i = 0; i < 10; ++i) crumbs.send_what_is_taken(many);
  });
  const auto body = crumbs.body();
  crumbs.connection().stop_receiving();  // ends the sender
  sender.join();
  REQUIRE_FALSE(body);
  CHECK(body.error().code == ErrorCode::bad_request);
  for (const std::string& sent : {std::string("\r\n\r\n\r\n\r\n\r\n\r\n\r\n\r\n\r\n"),
                                  std::string("\x16\x03\x01"), std::string(1, '\0')}) {
    Fixture f;
    f.send(sent);
    const auto head = f.connection().read_head();
    REQUIRE_FALSE(head);
    CHECK(head.error().code == ErrorCode::bad_request);
  }
}

TEST_CASE("an evicted client's waits end, in a body and in an answer") {
  ConnectionLimits patient;
  patient.body_bytes = 1000;
  const auto began = std::chrono::steady_clock::now();
  Fixture body(patient);
  body.begin("Content-Length: 3\r\n");
  std::jthread first([&] {
    while (body.connection().waiting(std::chrono::steady_clock::now()).phase != ClientPhase::body) {
      std::this_thread::sleep_for(1ms);
    }
    body.connection().evict();
  });
  const auto got = body.body();
  REQUIRE_FALSE(got);
  CHECK(got.error().code == ErrorCode::unavailable);
  Fixture answer(patient);
  std::jthread second([&] {
    auto now = [] { return std::chrono::steady_clock::now(); };
    while (answer.connection().waiting(now()).phase != ClientPhase::answer ||
           answer.connection().waiting(now()).lag < 100ms) {
      std::this_thread::sleep_for(1ms);
    }
    answer.connection().evict();
  });
  CHECK_FALSE(answer.connection().send(std::string(64 << 20, 'x')));
  CHECK(std::chrono::steady_clock::now() - began < patient.stall);
}

TEST_CASE("an answer under way goes on in a server that stops, for a client that reads") {
  Fixture f;
  f.stop().raise();
  std::atomic<std::size_t> read = 0;
  std::jthread reader([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const std::size_t got = f.answer().size();
      read += got;
      if (got == 0) std::this_thread::sleep_for(1ms);
    }
  });
  constexpr std::size_t kMuch = 2 << 20;
  REQUIRE(f.connection().send(std::string(kMuch, 'x')));
  while (read < kMuch) std::this_thread::sleep_for(1ms);
}

TEST_CASE("an endless request line and endless headers are told apart") {
  const auto refusal_of = [](const std::string& sent) {
    Fixture f;
    f.send(sent);
    const auto head = f.connection().read_head();
    REQUIRE_FALSE(head);
    return head.error().code;
  };
  CHECK(refusal_of(std::string(kMaxHeadBytes + 1000, 'x')) == ErrorCode::uri_too_long);
  // Its end may have come with the bytes that are too many.
  CHECK(refusal_of(std::string(kMaxHeadBytes + 1000, 'x') + "\r\nA: b\r\n\r\n") ==
        ErrorCode::uri_too_long);
  std::string headers = "GET / HTTP/1.1\r\n";
  while (headers.size() < kMaxHeadBytes + 1000) headers += "A: " + std::string(1000, 'x') + "\r\n";
  CHECK(refusal_of(headers) == ErrorCode::headers_too_large);
}

TEST_CASE("a raised stop flag ends the wait for a client") {
  ConnectionLimits patient;
  patient.body_bytes = 1000;
  Fixture f(patient);
  f.stop().raise();
  const auto nothing = f.connection().read_head();
  REQUIRE(nothing);
  CHECK_FALSE(*nothing);
}

TEST_CASE("a client that hangs up is noticed") {
  Fixture f;
  CHECK(f.connection().client_is_there());
  f.close_sending();
  CHECK_FALSE(f.connection().client_is_there());
}
