#include "server/fairwayd/commands/health_command.h"

#include <string>

#include <fmt/format.h>
#include <httplib.h>

namespace fairway {
namespace {

constexpr int kPatienceSeconds = 5;

/// Where a service that listens on an address of its own is reached from here.
std::string reachable(const std::string& host) {
  if (host == "0.0.0.0") return "127.0.0.1";
  return host == "::" ? "::1" : host;
}

}  // namespace

Result<void> check_health(const Settings& settings) {
  if (settings.listen.port == 0) {
    return Error{ErrorCode::usage, "A service on any free port cannot be asked: give --listen."};
  }
  httplib::Client client(reachable(settings.listen.host), settings.listen.port);
  client.set_connection_timeout(kPatienceSeconds);
  client.set_read_timeout(kPatienceSeconds);
  const httplib::Result answer = client.Get("/readyz");
  if (!answer) {
    return Error{ErrorCode::unavailable,
                 fmt::format("Nothing answers at {}: does it run, and is this its --listen?",
                             to_string(settings.listen))};
  }
  if (answer->status == 200) return {};
  return Error{ErrorCode::unavailable, "The service is not ready: " + answer->body};
}

}  // namespace fairway
