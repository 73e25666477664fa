// The settings of fairwayd from flags, variables and a file, by the one table of settings.

#include "server/fairwayd/settings/settings.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/fairwayd/settings/setting_table.h"
#include "server/fairwayd/settings/settings_file.h"
#include "server/os/kill_point.h"

namespace fairway {
namespace {

constexpr std::string_view kPrefix = "FAIRWAY_";
constexpr std::string_view kConfigVariable = "FAIRWAY_CONFIG";
/// Variables with the prefix that others read: tests, and the batch client.
constexpr std::array<std::string_view, 2> kForeignVariables = {"FAIRWAY_SHARED", "FAIRWAY_API_KEY"};

Settings default_settings() {
  Settings settings;
  settings.workers = std::max(1U, std::thread::hardware_concurrency());
  return settings;
}

/// The flags, as texts.
struct CommandLine {
  CommandLine() {
    const Settings defaults = default_settings();
    app.set_help_flag();
    app.add_flag("--help,-h", help, "Print this and exit");
    app.add_flag("--version", version, "Print the version and exit");
    app.add_flag("--print-config", print_config,
                 "Print the settings in force as a file for --config, and exit");
    app.add_flag("--health", health,
                 "Ask the service that runs with these settings whether it is ready, and exit");
    app.add_option("--config", config, "A file of lines \"name = value\", # begins a comment")
        ->type_name("FILE");
    const auto rows = setting_rows();
    values.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      app.add_option(flag_of(rows[i]), values[i], std::string(rows[i].help))
          ->type_name(std::string(rows[i].value_name))
          ->default_str(text_of(defaults, rows[i]));
    }
    app.footer(
        "\nEvery option may also be a variable (--max-body: FAIRWAY_MAX_BODY) or a line of the "
        "file (max-body = 1000).\nA flag wins over a variable, a variable over the file.\n\n"
        "SIGTERM and SIGINT stop it: running jobs may end within --drain seconds; what does not "
        "goes back\nto the queue and is done after the next start. A second signal ends the "
        "wait.\n\n"
        "fairwayd keys add|list|revoke: keys for --auth keys. fairwayd tenants list|set: shares of "
        "the service.\nfairwayd webhooks secret show|rotate: the secret that signs webhooks; after "
        "rotate the old one\nsigns, too, for a day.");
  }

  CLI::App app{"fairwayd: the mesh-denoising service", "fairwayd"};
  bool help = false;
  bool version = false;
  bool print_config = false;
  bool health = false;
  std::string config;
  std::vector<std::string> values;  ///< of each row of the table
};

Error usage(const std::string& message) {
  return {ErrorCode::usage, message + " See fairwayd --help."};
}

/// Writes a value into the settings and keeps where it came from.
Result<void> take(Settings& settings, const SettingRow& row, std::string_view text,
                  const std::string& origin, std::string_view subject = {}) {
  if (auto done = assign(settings, row, text); !done) {
    return usage(fmt::format("{}{} {}", origin, subject, done.error().message));
  }
  const auto place = static_cast<std::size_t>(&row - setting_rows().data());
  settings.origins.at(place) = origin;
  return {};
}

Result<void> take_file(Settings& settings, const std::string& file) {
  if (file.empty()) return {};
  const auto lines = read_settings_file(file);
  if (!lines) return lines.error();
  for (const SettingLine& line : *lines) {
    const std::string place = fmt::format("{}:{}", file, line.line);
    const SettingRow* row = find_setting(line.name);
    if (row == nullptr) return usage(fmt::format("{} There is no \"{}\".", place, line.name));
    if (auto done = take(settings, *row, line.value, place, " " + line.name); !done) return done;
  }
  return {};
}

using Variables = std::map<std::string, std::string, std::less<>>;

/// Those with our prefix that are not empty.
Variables variables_of(std::span<const std::string> environment) {
  Variables variables;
  for (const std::string& entry : environment) {
    const std::size_t equals = entry.find('=');
    if (!entry.starts_with(kPrefix) || equals == std::string::npos) continue;
    if (equals + 1 < entry.size()) {
      variables.emplace(entry.substr(0, equals), entry.substr(equals + 1));
    }
  }
  return variables;
}

Result<void> take_variables(Settings& settings, Variables variables) {
  for (const SettingRow& row : setting_rows()) {
    const auto found = variables.find(variable_of(row));
    if (found == variables.end()) continue;
    if (auto done = take(settings, row, found->second, found->first); !done) return done;
    variables.erase(found);
  }
  for (const auto& [name, value] : variables) {
    const bool foreign = is_kill_variable(name) ||
                         std::find(kForeignVariables.begin(), kForeignVariables.end(), name) !=
                             kForeignVariables.end();
    if (name != kConfigVariable && !foreign) {
      settings.unknown_variables.push_back(name);
    }
  }
  return {};
}

Result<void> take_flags(Settings& settings, const CommandLine& line) {
  const auto rows = setting_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string flag = flag_of(rows[i]);
    if (line.app.count(flag) == 0) continue;
    if (auto done = take(settings, rows[i], line.values[i], flag); !done) return done;
  }
  return {};
}

}  // namespace

Result<Settings> parse_settings(std::span<const char* const> arguments,
                                std::span<const std::string> environment) {
  CommandLine line;
  // CLI11 takes the arguments from the back.
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    line.app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    return usage(std::string(e.what()) + ".");
  }
  Settings settings = default_settings();
  settings.help = line.help;
  settings.version = line.version;
  settings.print_config = line.print_config;
  settings.health = line.health;
  if (settings.help || settings.version) return settings;
  settings.origins.assign(setting_rows().size(), "default");

  Variables variables = variables_of(environment);
  const auto file = variables.find(kConfigVariable);
  if (line.config.empty() && file != variables.end()) line.config = file->second;
  if (auto done = take_file(settings, line.config); !done) return done.error();
  if (auto done = take_variables(settings, std::move(variables)); !done) return done.error();
  if (auto done = take_flags(settings, line); !done) return done.error();
  // Who only asks needs no data.
  if (settings.data.empty() && !settings.health)
    return usage("--data DIR is needed: where jobs and meshes are kept.");
  return settings;
}

std::string print_settings(const Settings& settings) {
  std::string text;
  const auto rows = setting_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += fmt::format("# {}\n{} = {}\n", settings.origins.at(i), rows[i].name,
                        text_of(settings, rows[i]));
  }
  return text;
}

std::string usage_text() {
  return CommandLine().app.help();
}

}  // namespace fairway
