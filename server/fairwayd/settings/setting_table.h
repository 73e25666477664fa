#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.h"
#include "server/fairwayd/settings/settings.h"

namespace fairway {

/// One setting. Flag, variable, line of a file, --help and --print-config all come from its row.
struct SettingRow {
  using Target = std::variant<std::uint64_t Settings::*, std::chrono::seconds Settings::*,
                              std::filesystem::path Settings::*, ListenAddress Settings::*,
                              std::optional<ListenAddress> Settings::*, AuthMode Settings::*,
                              std::vector<std::string> Settings::*, bool Settings::*>;

  std::string_view name;        ///< "max-body": --max-body, FAIRWAY_MAX_BODY, max-body = …
  std::string_view value_name;  ///< of its value in --help
  std::string_view help;
  Target target;
  std::uint64_t low = 0;  ///< limits of a number, or of seconds
  std::uint64_t high = 0;
};

/// All settings, in the order of --help.
std::span<const SettingRow> setting_rows();

/// The row of a name; null where there is none.
const SettingRow* find_setting(std::string_view name);

/// "--max-body".
std::string flag_of(const SettingRow& row);
/// "FAIRWAY_MAX_BODY".
std::string variable_of(const SettingRow& row);

/// Reads a value. Errors: usage, a sentence without its subject: "takes HOST:PORT."
Result<void> assign(Settings& settings, const SettingRow& row, std::string_view text);

/// The value as assign() reads it.
std::string text_of(const Settings& settings, const SettingRow& row);

}  // namespace fairway
