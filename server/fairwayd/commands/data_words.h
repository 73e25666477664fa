#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"

namespace CLI {
class App;
}

namespace fairway {

/// How a command beside the service is told whose data it works on: --data, or a --config that says
/// it, or the environment, as the service itself.
struct DataWords {
  std::string data;
  std::string config;

  /// Adds the two options to a command.
  void add_to(CLI::App& command);

  /// The data directory. Errors: as parse_settings().
  Result<std::filesystem::path> directory(std::span<const std::string> environment) const;
};

}  // namespace fairway
