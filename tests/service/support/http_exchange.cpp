#include "tests/service/support/http_exchange.h"

#include <array>
#include <cctype>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/os/unique_fd.h"
#include "tests/service/support/event_text.h"

namespace fairway::test {
namespace {

constexpr time_t kPatience = 200;

/// Without a descriptor where that fails. Asserts nothing: threads of tests connect, too.
UniqueFd connected(std::uint16_t port) {
  UniqueFd socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    return UniqueFd();
  const timeval patience{kPatience, 0};
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return socket;
}

std::string bytes_of(const WireRequest& request) {
  std::string text = fmt::format("{} {} HTTP/1.1\r\nHost: t\r\nConnection: close\r\n",
                                 request.method, request.path);
  for (const std::string& header : request.headers) text += header + "\r\n";
  if (request.says_length && !request.body.empty()) {
    text += fmt::format("Content-Length: {}\r\n", request.body.size());
  }
  return text + "\r\n" + request.body;
}

void send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // refused meanwhile: the answer tells
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

/// Everything until the server closes.
std::string receive_all(int socket) {
  std::string text;
  std::array<char, 65536> chunk;
  for (ssize_t got; (got = ::recv(socket, chunk.data(), chunk.size(), 0)) > 0;) {
    text.append(chunk.data(), static_cast<std::size_t>(got));
  }
  return text;
}

}  // namespace

Answer parsed_answer(std::string_view text) {
  Answer answer;
  const std::size_t end = text.find("\r\n\r\n");
  constexpr std::string_view kVersion = "HTTP/1.1 ";
  if (!text.starts_with(kVersion) || end == std::string_view::npos) return answer;
  answer.status = std::stoi(std::string(text.substr(kVersion.size(), 3)));
  std::string_view head = text.substr(0, end);
  while (head.find("\r\n") != std::string_view::npos) {
    head.remove_prefix(head.find("\r\n") + 2);
    const std::string_view line = head.substr(0, head.find("\r\n"));
    std::string name(line.substr(0, line.find(": ")));
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::string& value = answer.headers[name];
    if (!value.empty()) value += ", ";
    value += line.substr(line.find(": ") + 2);
  }
  const std::string_view body = text.substr(end + 4);
  const bool chunked = answer.header("transfer-encoding") == "chunked" && !body.empty();
  answer.body = chunked ? without_chunks(body) : std::string(body);
  return answer;
}

Answer exchange(std::uint16_t port, const WireRequest& request) {
  const UniqueFd socket = connected(port);
  send_all(socket.get(), bytes_of(request));
  return parsed_answer(receive_all(socket.get()));
}

}  // namespace fairway::test
