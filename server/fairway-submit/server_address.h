#pragma once

#include <string>
#include <string_view>

#include "core/result.h"

namespace fairway {

/// Where a fairwayd is reached.
struct ServerAddress {
  bool encrypted = false;  ///< https
  std::string host;        ///< a name or an address; IPv6 without its brackets
  int port = 80;
  std::string prefix;  ///< path before "/v1", without a slash at its end
};

/// Parses "http://host:8080/prefix" or the same with https. Errors: usage (another scheme, a user,
/// a query, a port that is none).
Result<ServerAddress> parse_server_address(std::string_view url);

/// The URL of an address, the same for all that mean the same.
std::string to_string(const ServerAddress& address);

}  // namespace fairway
