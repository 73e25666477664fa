#include "server/fairway-submit/server_address.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr int kPlainPort = 80;
constexpr int kEncryptedPort = 443;
constexpr int kLastPort = 65535;

Error refused(std::string_view url) {
  return {ErrorCode::usage,
          fmt::format("{} is not the URL of a server: give http://HOST:PORT or https://HOST:PORT.",
                      url)};
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// Printable ASCII without what ends or splits an authority or a path.
bool is_plain(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return c > ' ' && c < '\x7f' && std::string_view("@?#\"<>\\^`{|}").find(c) == std::string::npos;
  });
}

}  // namespace

Result<ServerAddress> parse_server_address(std::string_view url) {
  ServerAddress address;
  const std::size_t scheme_end = url.find("://");
  if (scheme_end == std::string_view::npos || !is_plain(url)) return refused(url);
  const std::string scheme = lower(url.substr(0, scheme_end));
  if (scheme != "http" && scheme != "https") return refused(url);
  address.encrypted = scheme == "https";
  address.port = address.encrypted ? kEncryptedPort : kPlainPort;

  std::string_view authority = url.substr(scheme_end + 3);
  if (const std::size_t slash = authority.find('/'); slash != std::string_view::npos) {
    address.prefix = authority.substr(slash);
    authority = authority.substr(0, slash);
    while (address.prefix.ends_with('/')) address.prefix.pop_back();
  }
  const bool six = authority.starts_with('[');
  const std::size_t host_end = six ? authority.find(']') : authority.find(':');
  if (six && host_end == std::string_view::npos) return refused(url);
  address.host = lower(authority.substr(six ? 1 : 0, six ? host_end - 1 : host_end));
  std::string_view port;
  if (host_end != std::string_view::npos) port = authority.substr(host_end + (six ? 1 : 0));
  if (address.host.empty()) return refused(url);
  if (port.empty()) return address;
  port.remove_prefix(1);
  const auto [end, status] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  const bool whole = status == std::errc() && end == port.data() + port.size();
  if (!whole || address.port < 1 || address.port > kLastPort) return refused(url);
  return address;
}

std::string to_string(const ServerAddress& address) {
  const bool six = address.host.find(':') != std::string::npos;
  return fmt::format("{}://{}:{}{}", address.encrypted ? "https" : "http",
                     six ? fmt::format("[{}]", address.host) : address.host, address.port,
                     address.prefix);
}

}  // namespace fairway
