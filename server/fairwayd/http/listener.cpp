#include <cerrno>
#include <charconv>
#include <memory>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "server/fairwayd/http/http_server.h"
#include "server/os/file.h"

namespace fairway {
namespace {

constexpr int kBacklog = 1024;

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};

Error cannot_listen(const ListenAddress& address, int error_number) {
  const ErrorCode code = error_number == EADDRINUSE ? ErrorCode::conflict : ErrorCode::unavailable;
  return {code, system_sentence("listen on " + to_string(address), error_number)};
}

/// Says of a listener what its bound socket says.
void describe(Listener& listener) {
  constexpr std::uint32_t kLoopbackNet = 127;
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (::getsockname(listener.socket.get(), reinterpret_cast<sockaddr*>(&name), &size) != 0) return;
  if (name.ss_family == AF_INET6) {
    const auto& six = reinterpret_cast<const sockaddr_in6&>(name);
    listener.address.port = ntohs(six.sin6_port);
    listener.is_loopback = IN6_IS_ADDR_LOOPBACK(&six.sin6_addr) != 0;
  } else {
    const auto& four = reinterpret_cast<const sockaddr_in&>(name);
    listener.address.port = ntohs(four.sin_port);
    listener.is_loopback = ntohl(four.sin_addr.s_addr) >> 24U == kLoopbackNet;
  }
}

}  // namespace

Result<ListenAddress> parse_listen_address(std::string_view text) {
  const Error usage{ErrorCode::usage, "An address has the form HOST:PORT, such as 127.0.0.1:8080."};
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return usage;
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  ListenAddress address{std::string(host), 0};
  const auto [stop, status] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (host.empty() || port.empty() || status != std::errc() || stop != port.data() + port.size()) {
    return usage;
  }
  return address;
}

std::string to_string(const ListenAddress& address) {
  const bool six = address.host.find(':') != std::string::npos;
  return (six ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

Result<Listener> listen_on(const ListenAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* raw = nullptr;
  const std::string port = std::to_string(address.port);
  if (const int error = ::getaddrinfo(address.host.c_str(), port.c_str(), &hints, &raw)) {
    return Error{ErrorCode::unavailable,
                 "Cannot listen on " + to_string(address) + ": " + ::gai_strerror(error) + "."};
  }
  const std::unique_ptr<addrinfo, FreeAddresses> found(raw);
  UniqueFd fd(::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd) return cannot_listen(address, errno);
  // SO_REUSEADDR only skips the wait after a restart; a second listener is still refused.
  const int one = 1;
  ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
  if (::bind(fd.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(fd.get(), kBacklog) != 0) {
    return cannot_listen(address, errno);
  }
  Listener listener{std::move(fd), address};
  describe(listener);
  return listener;
}

}  // namespace fairway
