#include "server/fairwayd/http/waiting_room.h"

#include <array>
#include <future>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <sys/socket.h>

#include "server/os/child_process.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view kGood = "GET /admitted HTTP/1.1\r\nHost: t\r\n\r\n";

std::string read_all(const UniqueFd& socket) {
  const timeval patience{20, 0};
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string text;
  std::array<char, 1000> space;
  ssize_t got = 0;
  while ((got = ::recv(socket.get(), space.data(), space.size(), 0)) > 0) {
    text.append(space.data(), static_cast<std::size_t>(got));
  }
  return got == 0 ? text : "the connection does not end";
}

void send(const UniqueFd& socket, std::string_view text) {
  REQUIRE(::send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL) ==
          static_cast<ssize_t>(text.size()));
}

/// A room, and whom it admits.
class Fixture {
 public:
  explicit Fixture(const WaitingRoomLimits& limits) {
    auto room = WaitingRoom::create(
        limits, [this](Visitor& visitor, std::string_view method, std::string_view path) {
          const bool admits = method == "GET" && path == "/admitted" && visitor.origin == "here";
          if (admits) admitted_.set_value(std::move(visitor.socket));
          return admits;
        });
    REQUIRE(room);
    room_ = *std::move(room);
  }

  UniqueFd guest() {
    auto ends = socket_pair();
    REQUIRE(ends);
    room_->enter({std::move(ends->second), "here"});
    return std::move(ends->first);
  }
  /// The one that was admitted.
  UniqueFd admitted() {
    auto socket = admitted_.get_future();
    REQUIRE(socket.wait_for(60s) == std::future_status::ready);
    return socket.get();
  }

 private:
  std::promise<UniqueFd> admitted_;
  std::unique_ptr<WaitingRoom> room_;
};

}  // namespace

TEST_CASE("a head that comes by bytes is looked at when it is whole, and left in the socket") {
  Fixture f({.patience = 600s});
  const UniqueFd client = f.guest();
  for (const char byte : kGood) send(client, {&byte, 1});
  const UniqueFd socket = f.admitted();
  std::array<char, 100> space;
  const ssize_t got = ::recv(socket.get(), space.data(), space.size(), 0);
  CHECK(std::string_view(space.data(), static_cast<std::size_t>(got)) == kGood);
}

TEST_CASE("who is not admitted, or does not end a head, is refused with words") {
  Fixture f({.patience = 50ms, .linger = 50ms});
  for (const std::string& sent :
       {std::string("GET /other HTTP/1.1\r\n\r\n"), std::string("POST /admitted HTTP/1.1\r\n\r\n"),
        std::string(kGood.substr(0, 30)), std::string("GET /admitted"), std::string("\r\n"),
        std::string(), std::string(100000, 'x'),
        "GET /other HTTP/1.1\r\nA: " + std::string(5000, 'x')}) {
    CAPTURE(sent.substr(0, 40));
    const UniqueFd client = f.guest();
    send(client, sent);
    const std::string answer = read_all(client);
    CHECK(answer.starts_with("HTTP/1.1 503 "));
    CHECK(answer.find("\r\nRetry-After: 2\r\n") != std::string::npos);
    CHECK(answer.find("\r\nConnection: close\r\n") != std::string::npos);
  }
}

TEST_CASE("in a full waiting room the oldest guest goes") {
  Fixture f({.guests = 2, .patience = 600s, .linger = 600s});
  std::vector<UniqueFd> clients;
  for (int i = 0; i < 3; ++i) clients.push_back(f.guest());
  CHECK(read_all(clients.at(0)).empty());
  send(clients.at(2), kGood);
  CHECK(f.admitted());
  send(clients.at(1), "GET /other HTTP/1.1\r\n\r\n");
  CHECK(read_all(clients.at(1)).starts_with("HTTP/1.1 503 "));
}
