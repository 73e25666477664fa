#include "tests/service/support/raw_connection.h"

#include <array>
#include <chrono>
#include <utility>

#include <catch2/catch.hpp>
#include <sys/socket.h>

#include "tests/service/support/http_client.h"

namespace fairway::test {

RawConnection::RawConnection(std::uint16_t port)
    : socket_(connect_to(port, std::chrono::seconds(60))) {}

void RawConnection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    REQUIRE(sent > 0);
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void RawConnection::close_sending() {
  ::shutdown(socket_.get(), SHUT_WR);
}

bool RawConnection::receive() {
  std::array<char, 4096> chunk;
  const ssize_t got = ::recv(socket_.get(), chunk.data(), chunk.size(), 0);
  if (got <= 0) return false;
  received_.append(chunk.data(), static_cast<std::size_t>(got));
  return true;
}

std::string RawConnection::read_until(std::string_view mark) {
  while (received_.find(mark) == std::string::npos) {
    CAPTURE(received_, mark);
    REQUIRE(receive());
  }
  const std::size_t end = received_.find(mark) + mark.size();
  std::string text = received_.substr(0, end);
  received_.erase(0, end);
  return text;
}

std::string RawConnection::read_all() {
  while (receive()) {
  }
  return std::exchange(received_, "");
}

}  // namespace fairway::test
