#include "server/fairwayd/commands/data_words.h"

#include <vector>

#include <CLI/CLI.hpp>

#include "server/fairwayd/settings/settings.h"

namespace fairway {

void DataWords::add_to(CLI::App& command) {
  command.add_option("--data", data, "The data directory; as fairwayd's own")->type_name("DIR");
  command.add_option("--config", config, "A file that says it")->type_name("FILE");
}

Result<std::filesystem::path> DataWords::directory(std::span<const std::string> environment) const {
  std::vector<const char*> arguments;
  if (!data.empty()) arguments.insert(arguments.end(), {"--data", data.c_str()});
  if (!config.empty()) arguments.insert(arguments.end(), {"--config", config.c_str()});
  const auto settings = parse_settings(arguments, environment);
  if (!settings) return settings.error();
  return settings->data;
}

}  // namespace fairway
