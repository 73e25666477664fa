#include "server/fairwayd/commands/webhooks_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/stat.h>

#include "server/fairwayd/commands/data_words.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"

namespace fairway {
namespace {

/// The commands as CLI11 reads them.
struct CommandLine {
  CommandLine() {
    app.require_subcommand(1);
    CLI::App* webhooks = app.add_subcommand("webhooks", "What receivers of webhooks need");
    webhooks->require_subcommand(1);
    CLI::App* secret = webhooks->add_subcommand("secret", "The secret that signs webhooks");
    secret->require_subcommand(1);
    add(*secret, "show", "Print it");
    rotate = add(*secret, "rotate", "Make a new one and print it; both sign for a while");
  }

  CLI::App* add(CLI::App& group, const char* name, const char* help) {
    CLI::App* made = group.add_subcommand(name, help);
    data.add_to(*made);
    made->add_option("--tenant", tenant, "Whose secret it is")->capture_default_str();
    return made;
  }

  CLI::App app{"fairwayd: what receivers of webhooks need", "fairwayd"};
  DataWords data;
  std::string tenant{kLocalTenant};
  CLI::App* rotate = nullptr;
};

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

Result<std::string> run_webhooks_command(std::span<const char* const> arguments,
                                         std::span<const std::string> environment) {
  CommandLine line;
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    line.app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    return line.app.help();
  } catch (const CLI::ParseError& e) {
    return Error{ErrorCode::usage, std::string(e.what()) + ". See --help."};
  }
  const auto data = line.data.directory(environment);
  if (!data) return data.error();
  auto outbox = open_outbox(*data);
  if (!outbox) return outbox.error();
  if (line.rotate->parsed()) {
    if (auto rotated = (*outbox)->rotate_secret(line.tenant); !rotated) return rotated.error();
    fmt::print(stderr, "fairwayd: the secret before this one signs, too, for {} hours.\n",
               kSecretOverlap.count());
  }
  const auto secrets = (*outbox)->secrets(line.tenant);
  if (!secrets) return secrets.error();
  return secrets->front() + "\n";
}

}  // namespace fairway
