#include "tests/bench/kept_connection.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/os/file.h"

namespace fairway::bench {
namespace {

constexpr std::size_t kReceive = 256 * 1024;
constexpr time_t kPatience = 120;

Error broken(int error_number) {
  return {ErrorCode::unavailable, system_sentence("talk to the server", error_number)};
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The status and the headers of a head, its line ends included.
Reply parse_head(std::string_view head) {
  constexpr std::size_t kVersion = std::string_view("HTTP/1.1 ").size();
  constexpr std::size_t kDigits = 3;
  Reply reply;
  if (head.size() > kVersion + kDigits) {
    std::from_chars(head.data() + kVersion, head.data() + kVersion + kDigits, reply.status);
  }
  std::size_t at = head.find("\r\n") + 2;
  for (std::size_t end; (end = head.find("\r\n", at)) != std::string_view::npos; at = end + 2) {
    const std::string_view line = head.substr(at, end - at);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::size_t value = std::min(line.find_first_not_of(" \t", colon + 1), line.size());
    reply.headers[lower(line.substr(0, colon))] = line.substr(value);
  }
  return reply;
}

}  // namespace

std::string Reply::header(const std::string& lower_name) const {
  const auto found = headers.find(lower_name);
  return found == headers.end() ? "" : found->second;
}

Result<void> KeptConnection::connect() {
  received_.clear();
  socket_ = UniqueFd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port_);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    return broken(errno);
  }
  const int one = 1;
  ::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  const timeval time{kPatience, 0};
  ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
  return {};
}

/// A server may close a connection between two requests.
bool KeptConnection::is_open() const {
  if (!socket_) return false;
  pollfd entry{socket_.get(), POLLIN | POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) == 0;
}

bool KeptConnection::receive() {
  const std::size_t had = received_.size();
  received_.resize(had + kReceive);
  const ssize_t got = ::recv(socket_.get(), received_.data() + had, kReceive, 0);
  received_.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return got > 0;
}

Result<Reply> KeptConnection::read_head() {
  while (true) {
    const std::size_t end = received_.find("\r\n\r\n");
    if (end != std::string::npos) {
      Reply reply = parse_head(std::string_view(received_).substr(0, end + 2));
      received_.erase(0, end + 4);
      return reply;
    }
    if (!receive()) return broken(errno);
  }
}

Result<void> KeptConnection::read_body(Reply& reply) {
  constexpr int kNoContent = 204;
  constexpr int kNotModified = 304;
  if (reply.status == kNoContent || reply.status == kNotModified) return {};
  const std::string length = reply.header("content-length");
  std::size_t size = 0;
  const char* end = length.data() + length.size();
  if (length.empty() || std::from_chars(length.data(), end, size).ptr != end) {
    return Error{ErrorCode::bad_request, "The answer does not say how long it is."};
  }
  std::size_t have = std::min(size, received_.size());
  reply.body = received_.substr(0, have);
  received_.erase(0, have);
  reply.body.resize(size);
  while (have < size) {
    const ssize_t got = ::recv(socket_.get(), reply.body.data() + have, size - have, 0);
    if (got <= 0) return broken(errno);
    have += static_cast<std::size_t>(got);
  }
  return {};
}

Result<void> KeptConnection::warm() {
  if (!is_open()) {
    if (auto done = connect(); !done) return done;
  }
  const auto alive = ask("GET", "/livez");
  if (!alive) return alive.error();
  return {};
}

Result<Reply> KeptConnection::ask(std::string_view method, std::string_view path,
                                  const Headers& headers, std::span<const std::byte> body) {
  if (!is_open()) {
    if (auto done = connect(); !done) return done.error();
  }
  std::string head = fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n", method, path, port_);
  for (const auto& [name, value] : headers) head += fmt::format("{}: {}\r\n", name, value);
  if (method == "POST") head += fmt::format("Content-Length: {}\r\n", body.size());
  head += "\r\n";
  const std::array<std::span<const std::byte>, 2> pieces = {std::as_bytes(std::span(head)), body};
  if (auto sent = write_all(socket_.get(), pieces); !sent) return sent.error();
  auto reply = read_head();
  if (!reply) return reply;
  if (auto read = read_body(*reply); !read) return read.error();
  return reply;
}

}  // namespace fairway::bench
