#include "tests/hostile/wire.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "tests/hostile/score.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

sockaddr_in address_of(const char* host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  ::inet_pton(AF_INET, host, &address.sin_addr);
  return address;
}

int milliseconds_until(steady_clock::time_point end) {
  const auto left = std::chrono::ceil<milliseconds>(end - steady_clock::now());
  return static_cast<int>(std::max(left, milliseconds(0)).count());
}

/// The length of the first answer's body in `text`, whose head ends at `body`; npos where it does
/// not say, or its chunks have not all come.
std::size_t body_length(const test::Answer& answer, std::string_view text, std::size_t body) {
  const std::string length = answer.header("content-length");
  if (!length.empty()) return std::strtoull(length.c_str(), nullptr, 10);
  if (answer.header("transfer-encoding") != "chunked") return std::string_view::npos;
  const std::size_t end = text.find("0\r\n\r\n", body);
  return end == std::string_view::npos ? end : end + 5 - body;
}

test::Answer parsed_head(std::string_view head) {
  test::Answer answer;
  constexpr std::size_t kStatusAt = 9;
  if (head.size() < kStatusAt + 3) return answer;
  answer.status = std::atoi(std::string(head.substr(kStatusAt, 3)).c_str());
  while (head.find("\r\n") != std::string_view::npos) {
    head.remove_prefix(head.find("\r\n") + 2);
    const std::string_view line = head.substr(0, head.find("\r\n"));
    const std::size_t colon = std::min(line.find(": "), line.size());
    std::string name(line.substr(0, colon));
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    answer.headers[name] = line.substr(std::min(colon + 2, line.size()));
  }
  return answer;
}

}  // namespace

Wire::Wire(std::uint16_t port, const char* from)
    : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const sockaddr_in own = address_of(from, 0);
  const sockaddr_in server = address_of("127.0.0.1", port);
  const bool connected =
      ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0 &&
      ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
  expect(connected, fmt::format("cannot connect: error {}", errno));
}

bool Wire::receive() {
  std::array<char, 65536> chunk;
  const ssize_t got = ::recv(socket_.get(), chunk.data(), chunk.size(), MSG_DONTWAIT);
  if (got > 0) received_.append(chunk.data(), static_cast<std::size_t>(got));
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) closed_ = true;
  return got > 0;
}

std::size_t Wire::send_some(std::string_view bytes) {
  const ssize_t sent =
      ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && errno != EAGAIN && errno != EINTR) closed_ = true;
  return sent > 0 ? static_cast<std::size_t>(sent) : 0;
}

std::size_t Wire::send(std::string_view bytes, milliseconds time) {
  const auto until = steady_clock::now() + time;
  std::size_t sent = 0;
  while (sent < bytes.size() && !closed_ && steady_clock::now() < until) {
    pollfd entry{socket_.get(), POLLIN | POLLOUT, 0};
    if (::poll(&entry, 1, milliseconds_until(until)) <= 0) continue;
    if ((entry.revents & POLLIN) != 0) receive();
    if ((entry.revents & (POLLOUT | POLLERR | POLLHUP)) != 0) sent += send_some(bytes.substr(sent));
  }
  return sent;
}

void Wire::half_close() {
  ::shutdown(socket_.get(), SHUT_WR);
}

void Wire::read_until_closed(milliseconds time) {
  const auto until = steady_clock::now() + time;
  while (!closed_ && steady_clock::now() < until) {
    pollfd entry{socket_.get(), POLLIN, 0};
    if (::poll(&entry, 1, milliseconds_until(until)) > 0) receive();
  }
}

void Wire::read_answer(milliseconds time) {
  const auto until = steady_clock::now() + time;
  while (!closed_ && answers_in(received_).whole.empty() && steady_clock::now() < until) {
    pollfd entry{socket_.get(), POLLIN, 0};
    if (::poll(&entry, 1, milliseconds_until(until)) > 0) receive();
  }
}

Answers answers_in(std::string_view received) {
  constexpr int kFirstFinal = 200;
  Answers answers;
  while (received.starts_with("HTTP/1.")) {
    const std::size_t end = received.find("\r\n\r\n");
    if (end == std::string_view::npos) break;
    test::Answer answer = parsed_head(received.substr(0, end));
    answers.heads.append(received.substr(0, end + 4));
    const std::size_t body = end + 4;
    const bool bare = answer.status < kFirstFinal || answer.status == 204 || answer.status == 304;
    std::size_t length = bare ? 0 : body_length(answer, received, body);
    // Without a length the end of the connection is the end of the body.
    if (length == std::string_view::npos) length = received.size() - body;
    if (received.size() - body < length) break;
    answer.body = received.substr(body, length);
    received.remove_prefix(body + length);
    if (answer.status >= kFirstFinal) answers.whole.push_back(std::move(answer));
  }
  answers.has_rest = !received.empty();
  return answers;
}

std::string head_of(std::string_view method, std::string_view path,
                    const std::vector<std::string>& lines) {
  std::string head = fmt::format("{} {} HTTP/1.1\r\nHost: t\r\n", method, path);
  for (const std::string& line : lines) head += line + "\r\n";
  return head + "\r\n";
}

}  // namespace fairway::hostile
