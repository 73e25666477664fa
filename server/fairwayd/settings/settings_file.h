#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace fairway {

/// One line "name = value" of a settings file.
struct SettingLine {
  std::string name;
  std::string value;  ///< without the blanks around it; may be empty
  std::size_t line = 0;
};

/// Reads lines "name = value"; empty lines and lines that begin with # are skipped. A # behind a
/// value is refused, since it is no comment there and would be taken for one. `file` is the name
/// that errors carry. Errors: usage, as "FILE:LINE …" (no such line, a name that came before).
Result<std::vector<SettingLine>> parse_settings_file(std::string_view text, std::string_view file);

/// The same of a file of at most 64 KiB. Errors: as above, io.
Result<std::vector<SettingLine>> read_settings_file(const std::filesystem::path& file);

}  // namespace fairway
