#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/commands/health_command.h"
#include "server/fairwayd/commands/tenant_command.h"
#include "server/fairwayd/commands/webhooks_command.h"
#include "server/fairwayd/service.h"
#include "server/fairwayd/settings/settings.h"

namespace {

int complain(const fairway::Error& error) {
  fmt::print(stderr, "fairwayd: {}\n", error.message);
  return fairway::problem_kind(error.code).exit_code;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable)
    variables.emplace_back(*variable);
  const std::span<const char* const> rest(arguments + 1,
                                          static_cast<std::size_t>(count > 0 ? count - 1 : 0));
  const bool for_webhooks = !rest.empty() && std::string_view(rest.front()) == "webhooks";
  if (for_webhooks || fairway::is_tenant_command(rest)) {
    const auto text = for_webhooks ? fairway::run_webhooks_command(rest, variables)
                                   : fairway::run_tenant_command(rest, variables);
    if (!text) return complain(text.error());
    fmt::print("{}", *text);
    return 0;
  }
  const auto settings = fairway::parse_settings(rest, variables);
  if (!settings) return complain(settings.error());
  if (settings->help) {
    fmt::print("{}", fairway::usage_text());
    return 0;
  }
  if (settings->version) {
    fmt::print("fairwayd {}\n", FAIRWAY_VERSION);
    return 0;
  }
  if (settings->print_config) {
    fmt::print("{}", fairway::print_settings(*settings));
    return 0;
  }
  if (settings->health) {
    const auto ready = fairway::check_health(*settings);
    if (ready) fmt::print("ready\n");
    return ready ? 0 : complain(ready.error());
  }
  const auto served = fairway::run_service(*settings);
  return served ? 0 : complain(served.error());
}
