#include "server/fairwayd/commands/webhooks_command.h"

#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <sys/stat.h>

#include "server/fairwayd/settings/settings.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"

namespace fairway {
namespace {

Error usage() {
  return {ErrorCode::usage,
          "Usage: fairwayd webhooks secret show|rotate [--tenant NAME] --data DIR"};
}

/// Takes "--tenant NAME" or "--tenant=NAME" out of the arguments.
Result<std::string> take_tenant(std::vector<const char*>& arguments) {
  constexpr std::string_view kFlag = "--tenant";
  std::string tenant(kLocalTenant);
  for (auto it = arguments.begin(); it != arguments.end();) {
    const std::string_view word = *it;
    if (word == kFlag) {
      it = arguments.erase(it);
      if (it == arguments.end()) return usage();
      tenant = *it;
    } else if (word.starts_with("--tenant=")) {
      tenant = word.substr(kFlag.size() + 1);
    } else {
      ++it;
      continue;
    }
    it = arguments.erase(it);
  }
  return tenant;
}

Result<std::unique_ptr<SqliteOutbox>> open_outbox(const std::filesystem::path& data) {
  const std::filesystem::path jobs = data / "jobs.sqlite";
  std::error_code error;
  if (!std::filesystem::exists(jobs, error)) {
    return Error{
        ErrorCode::not_found,
        fmt::format("There is no {}: name the --data of a fairwayd that has run.", jobs.string())};
  }
  ::umask(077);
  return SqliteOutbox::open(jobs);
}

}  // namespace

Result<void> run_webhooks_command(std::span<const char* const> arguments,
                                  std::span<const std::string> environment) {
  if (arguments.size() < 2 || std::string_view(arguments[0]) != "secret") return usage();
  const std::string_view verb = arguments[1];
  if (verb != "show" && verb != "rotate") return usage();
  std::vector<const char*> rest(arguments.begin() + 2, arguments.end());
  const auto tenant = take_tenant(rest);
  if (!tenant) return tenant.error();
  const auto settings = parse_settings(rest, environment);
  if (!settings) return settings.error();
  if (settings->help) return usage();
  auto outbox = open_outbox(settings->data);
  if (!outbox) return outbox.error();
  if (verb == "rotate") {
    if (auto rotated = (*outbox)->rotate_secret(*tenant); !rotated) return rotated.error();
    fmt::print(stderr, "fairwayd: the secret before this one signs, too, for {} hours.\n",
               kSecretOverlap.count());
  }
  const auto secrets = (*outbox)->secrets(*tenant);
  if (!secrets) return secrets.error();
  fmt::print("{}\n", secrets->front());
  return {};
}

}  // namespace fairway
